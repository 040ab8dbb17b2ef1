// SPDX-License-Identifier: BSD-3-Clause
// map.db's table `frames`: what front_tracker said about each frame when it tracked it.
#pragma once

#include <vector>

#include "base/files/sqlite.h"
#include "map_server/atlas/atlas.h"

namespace rumi::map_server {

// Writes the records of these frames. Throws SqliteError.
void write_frames(const Atlas& atlas, const std::vector<ImageId>& frames, Database& database);
// Reads the records into the atlas. Throws SqliteError, or std::runtime_error for an invalid value.
void read_frames(Database& database, Atlas* atlas);

}  // namespace rumi::map_server
