// SPDX-License-Identifier: BSD-3-Clause
// Finds another system on the bus before `rumi up` starts anything.
#pragma once

#include <chrono>
#include <set>
#include <string>

#include "base/result.h"
#include "bus/transport/bus.h"

namespace rumi::tool {

struct WantedPlaces {
  std::set<std::string> processes;  // each may be on the bus only once
  std::string camera_channel;       // on which camera_driver is to publish, as on the wire; empty: no camera_driver
};

// Asks, and listens for so long. An Error names who is there and what to do. If two systems ask at the same time, the
// earlier one may go on.
Result<> find_other_system(Bus& bus, const WantedPlaces& wanted, std::chrono::milliseconds listen);

}  // namespace rumi::tool
