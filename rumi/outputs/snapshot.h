// SPDX-License-Identifier: BSD-3-Clause
// Asks a live map_server for its whole database.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "base/result.h"
#include "bus/transport/bus.h"
#include "lcmtypes/rumi/process_status_t.hpp"

namespace rumi::tool {

struct Snapshot {
  std::vector<uint8_t> database;
  std::map<std::string, process_status_t> processes;  // by name: the last status heard from each process
  double localized_after_s = -1;                      // see map_status_t
};

// Returns the database of a live map_server. Waits timeout_s for the first sign of an answer, and as long for each
// further one, but listens for at least listen_s, in which every process tells its status. Times are the bus's. An
// Error if map_server refuses or falls silent. The bus must not be dispatched afterwards: its subscriptions refer to
// variables of this function.
Result<Snapshot> request_snapshot(Bus& bus, double timeout_s, double listen_s);

}  // namespace rumi::tool
