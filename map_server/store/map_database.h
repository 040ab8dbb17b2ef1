// SPDX-License-Identifier: BSD-3-Clause
// The file map.db: locked, checked and of the current schema version. Its errors are explained for users.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "base/files/sqlite.h"
#include "base/result.h"
#include "map_server/store/database_lock.h"

namespace rumi::map_server {

inline constexpr const char* kInMemory = ":memory:";

// How long a reader waits for another program that keeps the database locked.
inline constexpr std::chrono::seconds kReaderWait{10};

class MapDatabase {
 public:
  // Opens or creates FILE and takes FILE.lock; ":memory:" keeps nothing when it ends. Migrates a file of an older
  // schema version in one transaction. An Error if the file is locked, is damaged, is not a map, has a newer version or
  // is not writable.
  static Result<MapDatabase> open(const std::string& file);
  // Returns a copy of the file in memory; changes to the copy do not reach the file. Another process may have the file
  // open. An Error if the file does not exist, is still locked after `wait`, or for the reasons above.
  static Result<MapDatabase> copy_in_memory(const std::string& file, std::chrono::milliseconds wait);

  Database& sqlite() { return db_; }  // its functions throw SqliteError
  Error explain(const SqliteError& error) const;
  const std::string& file() const { return file_; }
  bool is_in_memory() const { return file_ == kInMemory; }

  int64_t bytes();          // size of the database; if that cannot be read now, the last known size
  int64_t changes() const;  // rows written since the database was opened
  // Limits the size of the database (rounded to pages). Writing more fails like writing to a full disk.
  void limit_bytes(int64_t bytes);
  // Returns some free pages to the file system if there are many.
  void give_back_pages();

 private:
  MapDatabase() = default;
  Result<> bring_to_our_version();
  void make_or_migrate(bool is_new, int64_t version);
  Error explain_busy() const;

  std::string file_;
  std::chrono::milliseconds wait_{};  // how long to wait for other programs that hold a lock
  int64_t bytes_ = 0;
  DatabaseLock lock_;
  Database db_;
};

}  // namespace rumi::map_server
