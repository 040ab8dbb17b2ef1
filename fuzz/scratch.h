// SPDX-License-Identifier: BSD-3-Clause
// A temporary folder for the files that the targets read. It is in memory if TMPDIR is not set and /dev/shm is
// writable, and is removed when the process ends.
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>

#include "fuzz/target.h"

namespace rumi::fuzz {

class Scratch {
 public:
  Scratch() {
    const bool in_memory = std::getenv("TMPDIR") == nullptr && access("/dev/shm", W_OK) == 0;
    std::string name = in_memory ? "/dev/shm" : std::filesystem::temp_directory_path().string();
    name += "/rumi_fuzz_XXXXXX";
    if (!mkdtemp(name.data())) throw std::runtime_error(name + ": cannot be made");
    folder_ = name;
  }
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  const std::string& folder() const { return folder_; }
  std::string operator/(const std::string& name) const { return folder_ + "/" + name; }
  // Writes the file, or replaces it. Returns its path.
  std::string write(const std::string& name, View bytes) const {
    const std::string file = *this / name;
    const int fd = open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
    if (fd < 0) throw std::runtime_error(file + ": cannot be written");
    const ssize_t written = ::write(fd, bytes.data(), bytes.size());
    close(fd);
    if (written != static_cast<ssize_t>(bytes.size())) throw std::runtime_error(file + ": cannot be written");
    return file;
  }

 private:
  std::string folder_;
};

inline const Scratch& scratch() {
  static const Scratch folder;
  return folder;
}

}  // namespace rumi::fuzz
