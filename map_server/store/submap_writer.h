// SPDX-License-Identifier: BSD-3-Clause
// Writes submaps into map.db: only elements whose revision is later than the file's.
#pragma once

#include "base/files/sqlite.h"
#include "map_server/atlas/atlas.h"
#include "map_server/store/stored_submaps.h"

namespace rumi::map_server {

class SubmapWriter {
 public:
  // `stored`: what the file holds. The writer keeps it up to date.
  SubmapWriter(Database& database, Deadline deadline, StoredSubmaps* stored)
      : db_(database), deadline_(deadline), stored_(stored) {}

  // Writes submaps until the deadline, but at least one in each call, so that it comes to an end. Returns true if all
  // are written. Throws SqliteError.
  bool write(const Atlas& atlas);

 private:
  StoredSubmap write_submap(const Submap& submap, const StoredSubmap& before);
  // Removes from the file the elements that were removed from the submap. If the submap no longer remembers all its
  // removals, removes all its elements from the file and returns false.
  bool remove_elements(const Submap& submap, const StoredSubmap& since);
  void write_keyframes(const Submap& submap, const StoredSubmap& since);
  void write_landmarks(const Submap& submap, const StoredSubmap& since);
  void write_poses(const Submap& submap, const StoredSubmap& since);

  Database& db_;
  Deadline deadline_;
  StoredSubmaps* stored_;
};

}  // namespace rumi::map_server
