// SPDX-License-Identifier: BSD-3-Clause
// Finds out whether a stream's calibration has changed since earlier sessions: a map made with two calibrations is
// bent.
#pragma once

#include <string>

#include "map_server/atlas/atlas.h"

namespace rumi::map_server {

// Describes the first quantity in which two calibrations differ too much to be of the same camera, as in "fx 525 there,
// 350 here". Returns an empty string if there is none.
std::string difference(const Camera& there, const Camera& here);

// Compares the submap's calibration with that of the first submap that its stream has from an earlier session. Returns
// an empty string if they agree, or if there is no such submap.
std::string other_calibration(const Atlas& atlas, const Submap& submap);

}  // namespace rumi::map_server
