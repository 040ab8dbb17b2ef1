// SPDX-License-Identifier: BSD-3-Clause
// Makes the messages that answer requests for the trajectory and for regions of the served map.
#pragma once

#include "lcmtypes/rumi/map_region_t.hpp"
#include "lcmtypes/rumi/trajectory_t.hpp"
#include "map_server/atlas/atlas.h"

namespace rumi::map_server {

trajectory_t make_trajectory(const Atlas& atlas, int64_t utime_us);

// Returns the landmarks and keyframes within `radius` (above 0) of `center`, in the map's unit and frame of reference.
map_region_t make_map_region(const Atlas& atlas, const Eigen::Vector3d& center, double radius, int64_t utime_us);

}  // namespace rumi::map_server
