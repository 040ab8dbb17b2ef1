// SPDX-License-Identifier: BSD-3-Clause
// Lets one process at a time do something, tied to a file (flock). The kernel releases the lock when the process ends,
// however it ends.
#pragma once

#include <optional>
#include <string>

#include "base/files/file_descriptor.h"

namespace rumi {

class FileLock {
 public:
  // Creates the file if it does not exist. Returns nothing if another process holds it, or if it cannot be created:
  // errno tells which (EWOULDBLOCK: held).
  static std::optional<FileLock> take(const std::string& file);
  // Writes the pid into the file, for people. On a full disk the lock holds without it.
  void sign() const;

 private:
  explicit FileLock(FileDescriptor file) : file_(std::move(file)) {}
  FileDescriptor file_;
};

// The pid that the holder of the lock has written, "unknown" if it has not; nothing if nobody holds it.
std::optional<std::string> holder_of_lock(const std::string& file);

}  // namespace rumi
