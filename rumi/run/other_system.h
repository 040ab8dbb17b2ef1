// SPDX-License-Identifier: BSD-3-Clause
// Finds out whether another system is on the bus, before `rumi up` starts anything.
#pragma once

#include <chrono>
#include <set>
#include <string>

#include "base/result.h"
#include "bus/transport/bus.h"

namespace rumi::tool {

struct WantedPlaces {
  std::set<std::string> processes;  // names of processes; the bus may have only one of each name
  std::string camera_channel;  // camera_driver's channel for images, as on the wire; empty: no camera_driver is started
};

// Asks for other processes, and listens for `listen`. An Error says which system was found and what to do. If two
// systems ask at the same time, the earlier one may start.
Result<> find_other_system(Bus& bus, const WantedPlaces& wanted, std::chrono::milliseconds listen);

}  // namespace rumi::tool
