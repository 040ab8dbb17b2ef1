// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <utility>

namespace rumi {

// A file descriptor that is closed with its owner; -1: none.
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
  // If the process was started without stdin or stdout, a new descriptor may be one of 0 to 2, which the child
  // replaces.
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
