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
  std::vector<TimedPose> poses;  // in order of time, one per time
  int skipped_lines = 0;         // lines that are no pose, or have a time that was there before
  std::string error;             // why the file could not be used; else empty
  bool ok() const { return error.empty(); }
};

// Reads TUM format; lines that start with '#' are comments. A file without a single pose is an error only if it has
// other lines than comments and empty ones.
TrajectoryFile read_trajectory(const std::string& file);

struct InputFrame {
  int64_t utime_us = 0;
  std::string state;
  int submap = 0;  // 0: no pose
  bool in_map = false;
  PoseSigmas sigmas = {};  // lengths in the map's unit if in_map, else in the submap's
};

struct FramesFile {
  std::vector<InputFrame> frames;  // in order of time
  std::string error;
  bool ok() const { return error.empty(); }
};

// Reads frames.csv: columns utime, state, submap, in_map in any order, named by the first line; also position_sigma,
// rotation_sigma_rad and log_scale_sigma if it has all three (older files do not). Deviations are not known if their
// fields are empty, or if pose_sigmas() says so.
FramesFile read_frames(const std::string& file);

}  // namespace rumi
