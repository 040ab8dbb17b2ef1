// SPDX-License-Identifier: BSD-3-Clause
// map.db's table `links`: how submaps lie relative to each other, for people and programs that read the file. The
// merger does not start from it: it also needs joints and matched landmarks, which are not stored, so it compares the
// submaps anew after a restart.
#pragma once

#include "base/files/sqlite.h"
#include "map_server/atlas/atlas.h"
#include "map_server/store/stored_submaps.h"
#include "map_server/store/submap_reader.h"

namespace rumi::map_server {

// Replaces the whole table. Throws SqliteError.
void write_links(const Atlas& atlas, const StoredSubmaps& stored, Database& database);
// Reads the links into the atlas. Throws SqliteError, or std::runtime_error for an invalid link.
void read_links(Database& database, const SubmapsByRow& keys, Atlas* atlas);

}  // namespace rumi::map_server
