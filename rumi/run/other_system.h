// SPDX-License-Identifier: BSD-3-Clause
// Before `rumi up` starts anything: is somebody on the bus already?
#pragma once

#include <chrono>
#include <set>
#include <string>

#include "bus/transport/bus.h"

namespace rumi::tool {

struct WantedPlaces {
  std::set<std::string> processes;  // of which there may be one on the bus
  std::string camera_channel;       // that a camera_driver is to publish on, as on the wire; empty: none is
};

// Asks, and listens for so long. Returns who is there and what to do, for a person; empty: nobody. Of two who ask at
// the same time the earlier one goes on.
std::string find_other_system(Bus& bus, const WantedPlaces& wanted, std::chrono::milliseconds listen);

}  // namespace rumi::tool
