// SPDX-License-Identifier: BSD-3-Clause
// Makes the tables of map.db, or brings those of an older schema version to ours, step by step.
#pragma once

#include <cstdint>

#include "base/files/sqlite.h"

namespace rumi::map_server {

// Both throw SqliteError; the caller holds a transaction, so that all of it happens or nothing.
void create_map_tables(Database& database);
void migrate_map(Database& database, int64_t version);  // the version that the database has, 1 or higher

}  // namespace rumi::map_server
