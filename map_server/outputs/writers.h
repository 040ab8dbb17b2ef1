// SPDX-License-Identifier: BSD-3-Clause
// An atlas as files for other programs. Where a function takes `after`, files tell of the frames of later sessions than
// that one only: a run's own ones, in a map that has frames of earlier runs, too. Every function returns an empty
// string, or the file and why it could not be written; a file is replaced whole or left as it was.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "map_server/atlas/atlas.h"

namespace rumi::map_server {

struct Colour {
  uint8_t red = 0, green = 0, blue = 0;
  bool operator==(const Colour&) const = default;
};
Colour submap_colour(SubmapKey key);
// What images show of landmarks. One that is not among them is written in the colour of its submap.
using LandmarkColours = std::map<LandmarkRef, Colour>;
Colour colour_of(const LandmarkRef& landmark, const LandmarkColours& colours);

inline constexpr int64_t kNoSession = INT64_MIN;  // before all

// TUM format, `t tx ty tz qx qy qz qw` = map_from_cam: one line per frame with a pose in the served map, session by
// session in time order. t: the frame's utime as seconds with 6 decimals, exactly.
std::string write_trajectory_tum(const Atlas& atlas, const std::string& file, int64_t after = kNoSession);

// The same for one submap, submap_from_cam in the submap's own gauge.
std::string write_submap_tum(const Submap& submap, const std::string& file);

// "003.txt", for a back submap "b003.txt"; of another session than that of the latest submap "s<session>-003.txt".
std::string submap_file_name(const Atlas& atlas, SubmapKey key);

// Header and one line per frame heard of, session by session in time order:
// utime,state,submap,in_map,position_sigma,rotation_sigma_rad,log_scale_sigma,session. submap: the one that has a pose
// for it now (front 1, 2, ..., back -1, -2, ...), 0 for none. in_map: 1 if it has a pose in the served map. The
// deviations are those of lcmtypes/track.lcm, in the map's unit where in_map, else in the submap's; empty where they
// are not known. A frame that got its pose after the fact has a submap although its state is NOT_INITIALIZED. state is
// UNKNOWN only where the bus lost the message about the frame.
std::string write_frames_csv(const Atlas& atlas, const std::string& file, int64_t after = kNoSession);

// Binary PLY of the served map: landmarks, then camera centres of all frames in white.
std::string write_ply(const Atlas& atlas, const std::string& file, const LandmarkColours& colours = {});

// All of it into a folder (created): trajectory.txt, frames.csv, submaps/NNN.txt, map.ply (of the whole map). Files in
// submaps/ that look like ours but were not written are removed: they are from an earlier run. What can be written is
// written; returns what could not, a line each.
std::vector<std::string> write_outputs(const Atlas& atlas, const std::string& folder, int64_t after = kNoSession,
                                       const LandmarkColours& colours = {});

// "1700000000.000042" for 1700000000000042.
std::string seconds_text(int64_t utime_us);

}  // namespace rumi::map_server
