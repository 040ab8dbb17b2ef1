// SPDX-License-Identifier: BSD-3-Clause
// map.db's table `links`: how submaps lie to each other, for whoever looks at the file. The merger does not begin with
// it: it needs joints and matched landmarks, which the table does not have, and compares submaps anew after a restart.
#pragma once

#include "base/files/sqlite.h"
#include "map_server/atlas/atlas.h"
#include "map_server/store/stored_submaps.h"
#include "map_server/store/submap_reader.h"

namespace rumi::map_server {

// Replaces the whole table. Throws SqliteError.
void write_links(const Atlas& atlas, const StoredSubmaps& stored, Database& database);
// Throws SqliteError, or std::runtime_error for a link that makes no sense.
void read_links(Database& database, const SubmapsByRow& keys, Atlas* atlas);

}  // namespace rumi::map_server
