// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "base/files/file_lock.h"
#include "base/result.h"

namespace rumi::map_server {

// The exclusive right to write a database, held as long as the object lives. Its destructor removes the lock file.
class DatabaseLock {
 public:
  static std::string file_of(const std::string& database) { return database + ".lock"; }

  DatabaseLock() = default;  // holds no lock
  // Returns an Error if another process has the lock (with its pid), or if the lock file cannot be made.
  static Result<DatabaseLock> take(const std::string& database);
  ~DatabaseLock();
  DatabaseLock(DatabaseLock&& other) noexcept { *this = std::move(other); }
  DatabaseLock& operator=(DatabaseLock&& other) noexcept;

 private:
  std::string file_;
  std::optional<FileLock> lock_;
};

}  // namespace rumi::map_server
