// SPDX-License-Identifier: BSD-3-Clause
// Finds out whether a stream goes on with another calibration than before: a map made with both is bent.
#pragma once

#include <string>

#include "map_server/atlas/atlas.h"

namespace rumi::map_server {

// Describes the first quantity in which two calibrations differ by more than a new calibration of the same camera
// explains: "fx 525 there, 350 here". Empty if there is none.
std::string difference(const Camera& there, const Camera& here);

// Compares the submap with those of its stream in earlier sessions. Empty if there are none.
std::string other_calibration(const Atlas& atlas, const Submap& submap);

}  // namespace rumi::map_server
