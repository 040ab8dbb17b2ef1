// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <utility>

namespace rumi {

// Owns a file descriptor and closes it in the destructor; -1 if it has none.
class FileDescriptor {
 public:
  FileDescriptor() = default;
  explicit FileDescriptor(int fd) : fd_(fd) {}
  ~FileDescriptor() { reset(); }
  FileDescriptor(FileDescriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  FileDescriptor& operator=(FileDescriptor&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  int get() const { return fd_; }
  explicit operator bool() const { return fd_ >= 0; }
  void reset() {
    if (fd_ >= 0) close(fd_);
    fd_ = -1;
  }
  // Makes sure that the descriptor is above 2. If the process was started without stdin or stdout, a new descriptor may
  // be one of 0 to 2, which a child replaces. Returns false if there is no descriptor or it cannot be duplicated.
  bool move_above_stdio() {
    if (fd_ < 0 || fd_ > STDERR_FILENO) return fd_ >= 0;
    FileDescriptor moved(fcntl(fd_, F_DUPFD_CLOEXEC, STDERR_FILENO + 1));
    std::swap(fd_, moved.fd_);
    return fd_ >= 0;
  }

 private:
  int fd_ = -1;
};

}  // namespace rumi
