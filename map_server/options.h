// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "base/command_line/options.h"
#include "map_server/merging/map_merger.h"

namespace rumi::map_server {

struct MapServerOptions {
  MergeOptions merge;
  std::string database = "map.db";  // the map's file, or ":memory:": none
  bool localize_only = false;       // localize in the database's map, which is not changed
  double snapshot_s = 0;            // period of the copies, s; 0: none
  std::string snapshot_file = "map-snapshot.db";
};

void describe(OptionTable& table, MergeOptions& o);

inline void describe(OptionTable& table, MapServerOptions& o) {
  table.group("map_server");
  table.add("map_server.database", &o.database,
            "SQLite file of the map, created when missing and continued when not; :memory: keeps nothing");
  table.add("map_server.localize_only", &o.localize_only,
            "place new submaps in the map of the database, which stays as it is; what is new is kept in memory only");
  table.add("map_server.snapshot_s", &o.snapshot_s, "s",
            "write a copy of the map this often, if it changed, and at the end; 0: never", 0, 1e6);
  table.add("map_server.snapshot_file", &o.snapshot_file, "the copy, replaced whole each time");
  describe(table, o.merge);
  table.for_users(
      {"map_server.database", "map_server.localize_only", "map_server.snapshot_s", "map_server.snapshot_file"});
}

}  // namespace rumi::map_server
