// SPDX-License-Identifier: BSD-3-Clause
// Trajectories in the TUM format, `t tx ty tz qx qy qz qw`: one line per frame with a pose. t is the frame's utime in
// seconds, exact to 6 decimals. Each function returns an Error that names the file if it cannot be written; the old
// file is either replaced completely or left unchanged.
#pragma once

#include <cstdint>
#include <string>

#include "base/result.h"
#include "map_server/atlas/atlas.h"

namespace rumi::map_server {

inline constexpr int64_t kNoSession = INT64_MIN;  // lower than every session

// Writes map_from_cam of the frames with a pose in the served map, session by session in order of time. Leaves out
// sessions up to `after`, because the map may have frames of earlier runs.
Result<> write_trajectory_tum(const Atlas& atlas, const std::string& file, int64_t after = kNoSession);

// Writes submap_from_cam of all frames of the submap, in the submap's own frame of reference.
Result<> write_submap_tum(const Submap& submap, const std::string& file);

// Returns "003.txt", or "b003.txt" for a back submap. If its session is not the latest one of the atlas, "s<session>-"
// precedes it.
std::string submap_file_name(const Atlas& atlas, SubmapKey key);

// Returns "1700000000.000042" for 1700000000000042.
std::string seconds_text(int64_t utime_us);

}  // namespace rumi::map_server
