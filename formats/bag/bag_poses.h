// SPDX-License-Identifier: BSD-3-Clause
// Where the camera of a bag was, as its transforms of frames (tf) tell it: those of TUM RGB-D have their truth so.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "slam/geometry/transform.h"

namespace rumi {

struct BagPoses {
  struct Pose {
    int64_t utime_us = 0;
    SE3 map_from_cam;  // from the frame of the images to that in which all others lie
  };
  std::vector<Pose> poses;  // by time, one per time
  bool has_transforms = true;
  std::string note;   // from which frames they are
  std::string error;  // empty, or why there are none
};

// `channel`: of the images, as open_bag() takes it.
BagPoses poses_in_bag(const std::filesystem::path& path, const std::string& channel);

}  // namespace rumi
