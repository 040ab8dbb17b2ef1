// SPDX-License-Identifier: BSD-3-Clause
// map.db's table `masks`: what never moves in the images of each stream.
#pragma once

#include "base/files/sqlite.h"
#include "map_server/atlas/atlas.h"

namespace rumi::map_server {

// Replaces the whole table. Throws SqliteError.
void write_masks(const Atlas& atlas, Database& database);
// Throws SqliteError, or std::runtime_error for a mask that makes no sense.
void read_masks(Database& database, Atlas* atlas);

}  // namespace rumi::map_server
