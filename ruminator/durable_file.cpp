// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/durable_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "bus/process.h"

namespace rumi {
namespace {

bool sync_path(const std::string& path, int flags) {
  const int fd = open(path.c_str(), flags | O_CLOEXEC);
  if (fd < 0) return false;
  const bool ok = fsync(fd) == 0;
  const int error = errno;
  close(fd);
  errno = error;
  return ok;
}

std::string problem(const std::string& file) {
  return fmt::format("{}: cannot be written ({})", file, std::strerror(errno));
}

}  // namespace

std::string temporary_name(const std::string& file) {
  return fmt::format("{}.{}.tmp", file, unique_process_name("ruminator"));
}

std::string commit_file(const std::string& temporary, const std::string& file) {
  const std::string folder = std::filesystem::path(file).parent_path().string();
  const bool ok = sync_path(temporary, O_RDWR) && std::rename(temporary.c_str(), file.c_str()) == 0 &&
                  sync_path(folder.empty() ? "." : folder, O_RDONLY | O_DIRECTORY);
  if (ok) return "";
  std::string error = problem(file);
  std::remove(temporary.c_str());
  return error;
}

std::string write_file_durably(const std::string& file, std::span<const uint8_t> bytes) {
  const std::string temporary = temporary_name(file);
  std::FILE* out = std::fopen(temporary.c_str(), "wbe");
  if (!out) return problem(file);
  const bool written = std::fwrite(bytes.data(), 1, bytes.size(), out) == bytes.size();
  std::string error = written ? "" : problem(file);
  if (std::fclose(out) != 0 && error.empty()) error = problem(file);
  if (error.empty()) return commit_file(temporary, file);
  std::remove(temporary.c_str());
  return error;
}

}  // namespace rumi
