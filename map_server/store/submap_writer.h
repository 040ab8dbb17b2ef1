// SPDX-License-Identifier: BSD-3-Clause
// Writes submaps into map.db: only what has a later revision than the file.
#pragma once

#include "base/files/sqlite.h"
#include "map_server/atlas/atlas.h"
#include "map_server/store/stored_submaps.h"

namespace rumi::map_server {

class SubmapWriter {
 public:
  // `stored` is kept up to date with what the file has.
  SubmapWriter(Database& database, Deadline deadline, StoredSubmaps* stored)
      : db_(database), deadline_(deadline), stored_(stored) {}

  // Writes submaps until the deadline, at least one at each call, so that there is an end. True when all are written.
  // Throws SqliteError.
  bool write(const Atlas& atlas);

 private:
  StoredSubmap write_submap(const Submap& submap, const StoredSubmap& before);
  // Removes from the file what was removed from the submap. False if the submap no longer remembers all its removals:
  // then the file has none of its elements any more.
  bool remove_elements(const Submap& submap, const StoredSubmap& since);
  void write_keyframes(const Submap& submap, const StoredSubmap& since);
  void write_landmarks(const Submap& submap, const StoredSubmap& since);
  void write_poses(const Submap& submap, const StoredSubmap& since);

  Database& db_;
  Deadline deadline_;
  StoredSubmaps* stored_;
};

}  // namespace rumi::map_server
