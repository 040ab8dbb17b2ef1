// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "base/result.h"
#include "map_server/outputs/trajectory_file.h"

namespace rumi::map_server {

// Writes frames.csv: a header, and one line for each known frame of the sessions later than `after`, session by session
// in order of time: utime,state,submap,in_map,position_sigma,rotation_sigma_rad,log_scale_sigma,session.
//
// submap: the submap that has a pose of the frame now (front 1, 2, ..., back -1, -2, ...), or 0. in_map: 1 if the frame
// has a pose in the served map. The sigmas are the standard deviations of lcmtypes/track.lcm, in the map's unit if
// in_map is 1, otherwise in the submap's; they are empty if unknown. A frame that got its pose later has a submap
// although its state is NOT_INITIALIZED. The state is UNKNOWN only if the bus lost the message about the frame.
//
// Returns an Error with the name of the file if it cannot be written.
Result<> write_frames_csv(const Atlas& atlas, const std::string& file, int64_t after = kNoSession);

}  // namespace rumi::map_server
