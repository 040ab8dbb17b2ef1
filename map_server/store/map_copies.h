// SPDX-License-Identifier: BSD-3-Clause
// Copies of a map.db that is in use: SQLite lets readers beside the writer.
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

// A whole database, to be sent.
struct DatabaseBytes {
  std::vector<uint8_t> bytes;
  int64_t checksum = 0;  // CRC-32
};

class MapCopies {
 public:
  // Writes a consistent, compact copy of all that is saved. An existing file is replaced in one step. An Error says why
  // the file cannot be written, or the database not read.
  static Result<> write(MapDatabase& database, const std::string& file);
  // Makes the same copy while the caller goes on saving: in a thread, or, without threads or without a file, when the
  // caller asks for the result. Until then the database must live and stay where it is.
  std::future<Result<>> begin(MapDatabase& database, const std::string& file, bool in_thread);
  std::future<Result<DatabaseBytes>> begin_bytes(MapDatabase& database, bool in_thread);
  // Copies in threads fail soon, also those that are begun later: the process ends.
  void call_off() { *called_off_ = true; }

 private:
  std::shared_ptr<std::atomic<bool>> called_off_ = std::make_shared<std::atomic<bool>>(false);
};

}  // namespace rumi::map_server
