// SPDX-License-Identifier: BSD-3-Clause
// Reads the outputs of a run: trajectories in TUM format (time tx ty tz qx qy qz qw, map_from_cam), and frames.csv.
// truth.h reads the truth.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "slam/geometry/transform.h"
#include "slam/map/pose_sigmas.h"

namespace rumi {

struct TimedPose {
  int64_t utime_us = 0;
  SE3 map_from_cam;
};

struct TrajectoryFile {
  std::vector<TimedPose> poses;  // by time, one per time
  int skipped_lines = 0;         // not a number, not finite, no rotation, no time, or one that was there before
  std::string error;             // empty, or why the file could not be used
  bool ok() const { return error.empty(); }
};

// TUM format; lines that start with '#' are comments. A file without a single usable line is an error only if it had
// lines.
TrajectoryFile read_trajectory(const std::string& file);

struct InputFrame {
  int64_t utime_us = 0;
  std::string state;
  int submap = 0;  // 0: no pose
  bool in_map = false;
  PoseSigmas sigmas = {};  // of lengths in the map's unit where in_map, else in the submap's
};

struct FramesFile {
  std::vector<InputFrame> frames;  // by time
  std::string error;
  bool ok() const { return error.empty(); }
};

// frames.csv: columns utime, state, submap, in_map in any order, named by the first line; position_sigma,
// rotation_sigma_rad and log_scale_sigma where it has all three (older files have not). Deviations that are empty, or
// none by pose_sigmas(), are not known.
FramesFile read_frames(const std::string& file);

}  // namespace rumi
