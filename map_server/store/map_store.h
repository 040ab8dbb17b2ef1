// SPDX-License-Identifier: BSD-3-Clause
// The atlas on disk: one SQLite file. What save() has accepted survives kill -9 and a loss of power at any moment (WAL,
// synchronous=FULL). The schema is in map_schema.h.
#pragma once

#include <chrono>
#include <cstdint>
#include <future>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "map_server/atlas/atlas.h"
#include "map_server/store/map_copies.h"
#include "map_server/store/map_database.h"
#include "map_server/store/stored_submaps.h"

namespace rumi::map_server {

// map_server cannot answer while it saves, so a tick saves no longer than this.
inline constexpr std::chrono::milliseconds kSaveBudget{15};

class MapStore {
 public:
  // As the functions of MapDatabase with these names; see there for the Errors.
  static Result<MapStore> open(const std::string& file);
  static Result<MapStore> copy_in_memory(const std::string& file, std::chrono::milliseconds wait = kReaderWait);

  // Returns the atlas as last saved, bit for bit. An Error if the content is inconsistent.
  Result<Atlas> load();

  // Writes all changes of the atlas since it was last saved or loaded, and the records of the named frames, in one
  // transaction: everything, or nothing and an Error. After an Error the next save() catches up. Submaps and placements
  // may take long to write: once `budget` is used up, the rest is left to the next save(). Until all of it is written,
  // the file keeps the previous map with its links.
  Result<> save(const Atlas& atlas, const std::vector<ImageId>& frames,
                std::optional<std::chrono::milliseconds> budget = {});
  // True if something is left to the next save().
  bool is_behind() const { return is_behind_; }

  // Returns the revision of the submap in the file, or 0 if the file does not have it.
  int64_t stored_revision(SubmapKey key) const;

  // These make copies as the functions of MapCopies do. The store must not be moved until a copy is complete.
  Result<> write_copy(const std::string& file) { return MapCopies::write(database_, file); }
  std::future<Result<>> begin_copy(const std::string& file, bool in_thread) {
    return copies_.begin(database_, file, in_thread);
  }
  std::future<Result<DatabaseBytes>> begin_copy_bytes(bool in_thread) {
    return copies_.begin_bytes(database_, in_thread);
  }
  void call_off_copies() { copies_.call_off(); }

  // As the functions of MapDatabase with these names.
  int64_t bytes() { return database_.bytes(); }
  int64_t changes() const { return database_.changes(); }
  const std::string& file() const { return database_.file(); }
  void limit_bytes(int64_t bytes) { database_.limit_bytes(bytes); }

 private:
  explicit MapStore(MapDatabase database) : database_(std::move(database)) {}

  MapDatabase database_;
  MapCopies copies_;
  // The content of the file when it was last saved or loaded.
  StoredSubmaps stored_;
  std::vector<Link> stored_links_;
  std::map<int64_t, StillMask> stored_masks_;
  bool is_behind_ = false;
};

// Reads a map without locking or changing its file. Errors as of copy_in_memory() and load().
Result<Atlas> load_atlas(const std::string& file, std::chrono::milliseconds wait = kReaderWait);

}  // namespace rumi::map_server
