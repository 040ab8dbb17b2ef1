// SPDX-License-Identifier: BSD-3-Clause
#include "base/files/whole_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>

#include "base/this_process/account_limits.h"
#include "base/this_process/process_name.h"

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

Error write_error(const std::string& file) {
  return {fmt::format("cannot write {}: {}", file, write_error_text(errno))};
}

}  // namespace

WholeFile::WholeFile(const std::string& file) : file_(file), temporary_(temporary_name(file)) {
  stream_ = std::fopen(temporary_.c_str(), "wbe");
  if (!stream_) note_error();
}

WholeFile::~WholeFile() {
  if (!stream_) return;
  std::fclose(stream_);
  std::remove(temporary_.c_str());
}

void WholeFile::note_error() {
  if (so_far_) so_far_ = write_error(file_);
}

void WholeFile::write(std::string_view bytes) {
  if (stream_ && std::fwrite(bytes.data(), 1, bytes.size(), stream_) != bytes.size()) note_error();
}

void WholeFile::overwrite(int64_t at, std::string_view bytes) {
  if (stream_ && fseeko(stream_, at, SEEK_SET) != 0) note_error();
  write(bytes);
  if (stream_ && fseeko(stream_, 0, SEEK_END) != 0) note_error();
}

Result<> WholeFile::commit() {
  if (!stream_) return so_far_;
  if (std::fclose(stream_) != 0) note_error();
  stream_ = nullptr;
  if (so_far_) return so_far_ = commit_file(temporary_, file_);
  std::remove(temporary_.c_str());
  return so_far_;
}

std::string temporary_name(const std::string& file) {
  return fmt::format("{}.{}.tmp", file, unique_process_name("rumi"));
}

Result<> commit_file(const std::string& temporary, const std::string& file) {
  const std::string folder = std::filesystem::path(file).parent_path().string();
  const bool ok = sync_path(temporary, O_RDWR) && std::rename(temporary.c_str(), file.c_str()) == 0 &&
                  sync_path(folder.empty() ? "." : folder, O_RDONLY | O_DIRECTORY);
  if (ok) return {};
  Error error = write_error(file);
  std::remove(temporary.c_str());
  return error;
}

}  // namespace rumi
