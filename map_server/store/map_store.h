// SPDX-License-Identifier: BSD-3-Clause
// The atlas on disk: one SQLite file. What save() has accepted is there after a kill -9 at any moment, and after a loss
// of power too (WAL, synchronous=FULL). The schema is in map_schema.h.
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

// map_server hears nobody while it saves, so a tick saves no longer than this.
inline constexpr std::chrono::milliseconds kSaveBudget{15};

class MapStore {
 public:
  // See MapDatabase, also for when an Error comes.
  static Result<MapStore> open(const std::string& file);
  static Result<MapStore> copy_in_memory(const std::string& file, std::chrono::milliseconds wait = kReaderWait);

  // The atlas as it was when last saved, bit for bit. An Error if the content contradicts itself.
  Result<Atlas> load();

  // Writes what changed in the atlas since it was last saved or loaded, and the records of the frames named, in one
  // transaction: all of it or, with an Error, nothing. After a failure the next save() catches up. Submaps and
  // where they lie may take long to write: when the time of a `budget` is over, the rest is left to the next save(),
  // and until all is written the file has the map as it was before, with its links.
  Result<> save(const Atlas& atlas, const std::vector<ImageId>& frames,
                std::optional<std::chrono::milliseconds> budget = {});
  // True if something is left to the next save().
  bool is_behind() const { return is_behind_; }

  // Revision of the submap in the file, 0 if it is not there.
  int64_t stored_revision(SubmapKey key) const;

  // See MapCopies. The store must stay where it is until the copy is there.
  Result<> write_copy(const std::string& file) { return MapCopies::write(database_, file); }
  std::future<Result<>> begin_copy(const std::string& file, bool in_thread) {
    return copies_.begin(database_, file, in_thread);
  }
  std::future<Result<DatabaseBytes>> begin_copy_bytes(bool in_thread) {
    return copies_.begin_bytes(database_, in_thread);
  }
  void call_off_copies() { copies_.call_off(); }

  // See MapDatabase.
  int64_t bytes() { return database_.bytes(); }
  int64_t changes() const { return database_.changes(); }
  const std::string& file() const { return database_.file(); }
  void limit_bytes(int64_t bytes) { database_.limit_bytes(bytes); }

 private:
  explicit MapStore(MapDatabase database) : database_(std::move(database)) {}

  MapDatabase database_;
  MapCopies copies_;
  // The content of the file, as it was last saved or loaded.
  StoredSubmaps stored_;
  std::vector<Link> stored_links_;
  std::map<int64_t, StillMask> stored_masks_;
  bool is_behind_ = false;
};

// Reads a map without locking or changing its file. An Error as from copy_in_memory() and load().
Result<Atlas> load_atlas(const std::string& file, std::chrono::milliseconds wait = kReaderWait);

}  // namespace rumi::map_server
