// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "slam/geometry/transform.h"
#include "slam/map/submap.h"

namespace rumi {

// What is known of how two submaps lie to each other; an accepted one holds the served map together.
struct Link {
  enum class Kind : int8_t {
    kSameImages = 0,  // made of some of the same images
    kAppearance = 1,  // saw the same place; a == b: a loop
  };
  SubmapKey a, b;
  Kind kind = Kind::kSameImages;
  Sim3 b_from_a;
  int keyframes = 0, keyframe_inliers = 0;  // compared, and that agree
  int landmarks = 0, landmark_inliers = 0;  // M_com, and those that agree
  double rmse_px = 0;                       // of the latter
  std::string doubt;                        // empty: accepted; else why not
  bool accepted() const { return doubt.empty(); }
};

}  // namespace rumi
