// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "base/result.h"
#include "map_server/outputs/trajectory_file.h"

namespace rumi::map_server {

// Writes frames.csv: a header, and one line per frame heard of in sessions later than `after`, session by session in
// time order: utime,state,submap,in_map,position_sigma,rotation_sigma_rad,log_scale_sigma,session.
//
// submap: the one that has a pose for the frame now (front 1, 2, ..., back -1, -2, ...), 0 for none. in_map: 1 if the
// frame has a pose in the served map. The deviations are those of lcmtypes/track.lcm, in the map's unit where in_map,
// else in the submap's; they are empty where they are not known. A frame that got its pose after the fact has a submap
// although its state is NOT_INITIALIZED. state is UNKNOWN only where the bus lost the message about the frame.
//
// An Error names the file if it cannot be written.
Result<> write_frames_csv(const Atlas& atlas, const std::string& file, int64_t after = kNoSession);

}  // namespace rumi::map_server
