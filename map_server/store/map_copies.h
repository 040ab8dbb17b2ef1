// SPDX-License-Identifier: BSD-3-Clause
// Makes copies of a map.db that is in use. SQLite allows reading while another connection writes.
#pragma once

#include <atomic>
#include <cstdint>
#include <future>
#include <memory>
#include <string>
#include <vector>

#include "base/result.h"
#include "map_server/store/map_database.h"

namespace rumi::map_server {

// The bytes of a whole database file.
struct DatabaseBytes {
  std::vector<uint8_t> bytes;
  int64_t checksum = 0;  // CRC-32 of the bytes
};

class MapCopies {
 public:
  // Writes a consistent, compact copy of everything saved, and replaces an existing file in one step. An Error if the
  // file cannot be written or the database cannot be read.
  static Result<> write(MapDatabase& database, const std::string& file);
  // Makes such a copy while the caller continues to save. It is made in a thread if `in_thread` and the database is a
  // file; otherwise when the caller gets the result. Until then the database must exist and must not be moved.
  std::future<Result<>> begin(MapDatabase& database, const std::string& file, bool in_thread);
  std::future<Result<DatabaseBytes>> begin_bytes(MapDatabase& database, bool in_thread);
  // Makes copies in threads fail soon, also later ones, because the process ends.
  void call_off() { *called_off_ = true; }

 private:
  std::shared_ptr<std::atomic<bool>> called_off_ = std::make_shared<std::atomic<bool>>(false);
};

}  // namespace rumi::map_server
