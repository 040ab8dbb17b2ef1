// SPDX-License-Identifier: BSD-3-Clause
// A lock on a file (flock) that one process at a time can hold. The kernel releases it when the process ends, however
// it ends.
#pragma once

#include <optional>
#include <string>

#include "base/files/file_descriptor.h"

namespace rumi {

class FileLock {
 public:
  // Creates the file if it does not exist. Returns nullopt if another process holds the lock (errno is EWOULDBLOCK) or
  // the file cannot be created.
  static std::optional<FileLock> take(const std::string& file);
  // Writes the pid into the file, for people. If the disk is full, nothing is written and the lock still holds.
  void sign() const;

 private:
  explicit FileLock(FileDescriptor file) : file_(std::move(file)) {}
  FileDescriptor file_;
};

// Returns the pid that the holder of the lock has written, "unknown" if it has written none; nullopt if nobody holds
// the lock, or the file cannot be opened.
std::optional<std::string> holder_of_lock(const std::string& file);

}  // namespace rumi
