// SPDX-License-Identifier: BSD-3-Clause
// The file map.db as a database of ours: locked, checked, of our schema version; and its errors in words for a person.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "base/files/sqlite.h"
#include "base/result.h"
#include "map_server/store/database_lock.h"

namespace rumi::map_server {

inline constexpr const char* kInMemory = ":memory:";

// A reader waits this long for another program that has a database locked.
inline constexpr std::chrono::seconds kReaderWait{10};

class MapDatabase {
 public:
  // Opens or creates FILE and takes FILE.lock; ":memory:" keeps everything in memory. A file of an older schema version
  // is brought to ours in one transaction. An Error if the file is locked, damaged, no map, of a newer version or not
  // writable.
  static Result<MapDatabase> open(const std::string& file);
  // Copies into memory what the file holds now: whatever becomes of the copy, the file stays as it is. Another process
  // may have it open. An Error if the file is not there, is still locked after `wait`, or as above.
  static Result<MapDatabase> copy_in_memory(const std::string& file, std::chrono::milliseconds wait);

  Database& sqlite() { return db_; }  // its functions throw SqliteError
  Error explain(const SqliteError& error) const;
  const std::string& file() const { return file_; }
  bool is_in_memory() const { return file_ == kInMemory; }

  int64_t bytes();          // the database's size; if that cannot be read now, the size of before
  int64_t changes() const;  // rows written since it was opened
  // The database takes no more than this many bytes (rounded to pages): writing more fails as on a full disk.
  void limit_bytes(int64_t bytes);
  // Gives some of the free pages back to the file system if there are many.
  void give_back_pages();

 private:
  MapDatabase() = default;
  Result<> bring_to_our_version();
  void make_or_migrate(bool is_new, int64_t version);
  Error explain_busy() const;

  std::string file_;
  std::chrono::milliseconds wait_{};  // for other programs, before a request fails
  int64_t bytes_ = 0;
  DatabaseLock lock_;
  Database db_;
};

}  // namespace rumi::map_server
