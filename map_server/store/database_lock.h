// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "base/files/file_lock.h"
#include "base/result.h"

namespace rumi::map_server {

// The right to write a database, held as long as the object lives. The lock's file is removed with it.
class DatabaseLock {
 public:
  static std::string file_of(const std::string& database) { return database + ".lock"; }

  DatabaseLock() = default;  // holds nothing
  // An Error that names the holder's pid if another process has the lock, or says why its file cannot be made.
  static Result<DatabaseLock> take(const std::string& database);
  ~DatabaseLock();
  DatabaseLock(DatabaseLock&& other) noexcept { *this = std::move(other); }
  DatabaseLock& operator=(DatabaseLock&& other) noexcept;

 private:
  std::string file_;
  std::optional<FileLock> lock_;
};

}  // namespace rumi::map_server
