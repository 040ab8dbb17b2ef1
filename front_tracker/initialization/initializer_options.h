// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slam/geometry/two_view.h"
#include "slam/map/tracking_state.h"

namespace rumi::front_tracker {

struct InitializerOptions {
  int keypoints = 2000;                // per image while there is no submap to track
  int min_matches = 100;               // with the reference image; fewer: a later reference
  int max_frames = kMostRetoldFrames;  // buffered; they get their poses once the submap stands
  int max_keyframes = 6;               // of the first bundle adjustment
  // Of the direction of the motion between the two images that begin a submap, the structure being whatever suits it:
  // standard deviation by what the images leave unexplained. Beyond it the submap may be bent: more motion is waited
  // for.
  double max_direction_sigma_rad = 0.03;
  double max_rival_rmse_ratio = 0.9;  // of the two best structures' errors, where two views allow two (a plane does)
  TwoViewOptions two_view;
};

}  // namespace rumi::front_tracker
