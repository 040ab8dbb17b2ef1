// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

namespace rumi {

// Creates a folder, and removes it with all its contents in the destructor.
class TemporaryFolder {
 public:
  // Creates the folder in `parent`; its name begins with `prefix`. Throws std::runtime_error if that fails.
  TemporaryFolder(const std::filesystem::path& parent, const std::string& prefix);
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace rumi
