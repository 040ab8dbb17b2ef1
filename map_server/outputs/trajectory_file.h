// SPDX-License-Identifier: BSD-3-Clause
// Trajectories in the TUM format, `t tx ty tz qx qy qz qw`: one line per frame with a pose. t is the frame's utime as
// seconds with 6 decimals, exactly. Each function returns an Error that names the file if it cannot be written; a file
// is replaced whole or left as it was.
#pragma once

#include <cstdint>
#include <string>

#include "base/result.h"
#include "map_server/atlas/atlas.h"

namespace rumi::map_server {

inline constexpr int64_t kNoSession = INT64_MIN;  // lower than all sessions

// Writes map_from_cam of the frames with a pose in the served map, session by session in time order: only of sessions
// later than `after`, so that the map may have frames of earlier runs too.
Result<> write_trajectory_tum(const Atlas& atlas, const std::string& file, int64_t after = kNoSession);

// Writes submap_from_cam of all frames of the submap, in the submap's own frame of reference.
Result<> write_submap_tum(const Submap& submap, const std::string& file);

// "003.txt", for a back submap "b003.txt"; if its session is not that of the latest submap, "s<session>-003.txt".
std::string submap_file_name(const Atlas& atlas, SubmapKey key);

// "1700000000.000042" for 1700000000000042.
std::string seconds_text(int64_t utime_us);

}  // namespace rumi::map_server
