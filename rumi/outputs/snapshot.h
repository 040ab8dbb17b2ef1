// SPDX-License-Identifier: BSD-3-Clause
// Asks a live map_server for its whole database.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "bus/transport/bus.h"
#include "lcmtypes/rumi/process_status_t.hpp"

namespace rumi::tool {

struct SnapshotResult {
  std::vector<uint8_t> database;
  std::map<std::string, process_status_t> processes;  // the last status heard from each, by name
  double localized_after_s = -1;                      // see map_status_t
  std::string error;                                  // empty, or why there is no database
};

// Waits timeout_s for the first sign of an answer and as long for each further one; afterwards listens until every
// process had time to tell its status, at least listen_s since the start. Times are the bus's. The bus must not be
// dispatched again afterwards: what was subscribed here is gone.
SnapshotResult request_snapshot(Bus& bus, double timeout_s, double listen_s);

}  // namespace rumi::tool
