// SPDX-License-Identifier: BSD-3-Clause
// map.db's tables placed_keyframes, placed_landmarks and fused_landmarks: where the submaps lie in the map.
//
// Placements take long to write. They are written in several transactions, under their new revisions; until all
// submaps' placements are written, the file keeps the previous map.
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
  // `stored`: what the file holds. The writer keeps it up to date.
  PlacementWriter(Database& database, Deadline deadline, StoredSubmaps* stored)
      : db_(database), deadline_(deadline), stored_(stored) {}

  // Writes placements until the deadline, but at least one in each call, so that it comes to an end. Returns true if
  // all are written.
  bool write(const Atlas& atlas);
  // Makes the written placements the valid ones: from now on the file has the new map.
  void make_valid(const Atlas& atlas);
  // Removes invalid placements until the deadline. Returns true if none is left.
  bool remove_others();

 private:
  void write_placement(const Placement& placement, int64_t row);

  Database& db_;
  Deadline deadline_;
  StoredSubmaps* stored_;
};

// Reads the placements of the atlas's submaps. Throws SqliteError, or std::runtime_error for an invalid placement.
void read_placements(Database& database, const SubmapsByRow& keys, const StoredSubmaps& stored, Atlas* atlas);

}  // namespace rumi::map_server
