// SPDX-License-Identifier: BSD-3-Clause
// Reads the path of a bag's camera from its transforms (tf): this is where bags of TUM RGB-D have their truth.
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
    SE3 map_from_cam;  // from the coordinate frame of the images to the root of the transforms
  };
  std::vector<Pose> poses;  // in order of time, one per time
  bool has_transforms = true;
  std::string note;   // names the two coordinate frames between which the poses are
  std::string error;  // why there are no poses; else empty
};

// `channel`: the topic of the images, as in open_bag().
BagPoses poses_in_bag(const std::filesystem::path& path, const std::string& channel);

}  // namespace rumi
