// SPDX-License-Identifier: BSD-3-Clause
#include "base/files/file_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace rumi {
namespace {

// True if `file` still names the opened file. The previous holder may have removed the opened file after this process
// opened it: a lock on a removed file excludes nobody.
bool is_still_there(int fd, const std::string& file) {
  struct stat ours {
  }, there{};
  return fstat(fd, &ours) == 0 && stat(file.c_str(), &there) == 0 && ours.st_ino == there.st_ino &&
         ours.st_dev == there.st_dev;
}

}  // namespace

std::optional<FileLock> FileLock::take(const std::string& file) {
  for (;;) {
    FileDescriptor opened(::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666));
    if (!opened || flock(opened.get(), LOCK_EX | LOCK_NB) != 0) return std::nullopt;
    if (is_still_there(opened.get(), file)) return FileLock(std::move(opened));
  }
}

void FileLock::sign() const {
  const std::string pid = std::to_string(getpid());
  if (ftruncate(file_.get(), 0) != 0 || pwrite(file_.get(), pid.data(), pid.size(), 0) < 0) return;
}

std::optional<std::string> holder_of_lock(const std::string& file) {
  const FileDescriptor opened(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
  if (!opened || flock(opened.get(), LOCK_SH | LOCK_NB) == 0) return std::nullopt;
  char text[32] = {};
  const ssize_t n = pread(opened.get(), text, sizeof(text) - 1, 0);
  return n > 0 ? std::string(text, static_cast<size_t>(n)) : "unknown";
}

}  // namespace rumi
