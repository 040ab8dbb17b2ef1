// SPDX-License-Identifier: BSD-3-Clause
// map.db's tables placed_keyframes, placed_landmarks and fused_landmarks: where the submaps of the map lie in it.
//
// Placements take long to write. They are written over several transactions, under the revision that they have in the
// map; until those of all submaps are there, the file has the map of before.
#pragma once

#include <cstdint>

#include "base/files/sqlite.h"
#include "map_server/atlas/atlas.h"
#include "map_server/store/stored_submaps.h"
#include "map_server/store/submap_reader.h"

namespace rumi::map_server {

// All functions throw SqliteError.
class PlacementWriter {
 public:
  // `stored` is kept up to date with what the file has.
  PlacementWriter(Database& database, Deadline deadline, StoredSubmaps* stored)
      : db_(database), deadline_(deadline), stored_(stored) {}

  // Writes placements until the deadline, at least one at each call, so that there is an end. True when all are
  // written.
  bool write(const Atlas& atlas);
  // From here on the written placements count, and the file has the map with them.
  void make_valid(const Atlas& atlas);
  // Removes placements that do not count, until the deadline. True when there are none left.
  bool remove_others();

 private:
  void write_placement(const Placement& placement, int64_t row);

  Database& db_;
  Deadline deadline_;
  StoredSubmaps* stored_;
};

// Gives the submaps of the atlas their placements. Throws SqliteError, or std::runtime_error for a placement that makes
// no sense.
void read_placements(Database& database, const SubmapsByRow& keys, const StoredSubmaps& stored, Atlas* atlas);

}  // namespace rumi::map_server
