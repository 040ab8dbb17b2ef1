// SPDX-License-Identifier: BSD-3-Clause
// Makes the tables of map.db, or migrates those of an older schema version step by step.
#pragma once

#include <cstdint>

#include "base/files/sqlite.h"

namespace rumi::map_server {

// Both throw SqliteError. The caller must hold a transaction, so that either everything is done or nothing.
void create_map_tables(Database& database);
void migrate_map(Database& database, int64_t version);  // `version`: of the database, 1 or higher

}  // namespace rumi::map_server
