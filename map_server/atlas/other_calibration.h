// SPDX-License-Identifier: BSD-3-Clause
// A stream that goes on with another calibration than before: a map that is made with both is bent.
#pragma once

#include <string>

#include "map_server/atlas/atlas.h"

namespace rumi::map_server {

// "fx 525 there, 350 here", by the first quantity of which two calibrations differ by more than calibrating once more
// explains; empty if there is none.
std::string difference(const Camera& there, const Camera& here);

// The same of the submap and what earlier sessions have of its stream; empty if they have nothing of it.
std::string other_calibration(const Atlas& atlas, const Submap& submap);

}  // namespace rumi::map_server
