// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slam/geometry/two_view.h"
#include "slam/map/tracking_state.h"

namespace rumi::front_tracker {

struct InitializerOptions {
  int keypoints = 2000;                // in an image while there is no submap to track
  int min_matches = 100;               // with the reference image; with fewer, a later reference is used
  int max_frames = kMostRetoldFrames;  // buffered; they get their poses once the submap stands
  int max_keyframes = 6;               // of the first bundle adjustment
  // The largest standard deviation, estimated from the residuals, of the direction of the motion between the two images
  // that begin a submap. If it is larger, the submap may be bent, so the initializer waits for more motion.
  double max_direction_sigma_rad = 0.03;
  double max_rival_rmse_ratio =
      0.9;  // ratio of the two best structures' errors, if the two views allow two (a plane does)
  TwoViewOptions two_view;
};

}  // namespace rumi::front_tracker
