// SPDX-License-Identifier: BSD-3-Clause
// map.db's table `masks`: the mask of the part that never moves, for each stream.
#pragma once

#include "base/files/sqlite.h"
#include "map_server/atlas/atlas.h"

namespace rumi::map_server {

// Replaces the whole table. Throws SqliteError.
void write_masks(const Atlas& atlas, Database& database);
// Reads the masks into the atlas. Throws SqliteError, or std::runtime_error for an invalid mask.
void read_masks(Database& database, Atlas* atlas);

}  // namespace rumi::map_server
