// SPDX-License-Identifier: BSD-3-Clause
// Reads the submaps of map.db, with their keyframes, landmarks and poses, and checks them.
#pragma once

#include <cstdint>
#include <map>

#include "base/files/sqlite.h"
#include "map_server/atlas/atlas.h"
#include "map_server/store/stored_submaps.h"

namespace rumi::map_server {

using SubmapsByRow = std::map<int64_t, SubmapKey>;  // the submaps' keys, by submaps.submap

// Adds all submaps to the atlas, without their placements. Returns their keys by row. Throws SqliteError, or
// std::runtime_error if a submap is inconsistent.
SubmapsByRow read_submaps(Database& database, Atlas* atlas, StoredSubmaps* stored);

}  // namespace rumi::map_server
