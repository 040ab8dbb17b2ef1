// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slam/geometry/two_view.h"
#include "slam/map/tracking_state.h"

namespace rumi::front_tracker {

struct InitializerOptions {
  int keypoints = 2000;                // keypoints wanted in an image while there is no submap to track
  int min_matches = 100;               // matches with the reference image, at least; with fewer, a later reference is
                                       // used
  int max_frames = kMostRetoldFrames;  // frames that are buffered, at most; they get their poses when the submap begins
  int max_keyframes = 6;               // keyframes in the first bundle adjustment, at most
  // The largest standard deviation of the direction of motion between the two images that begin a submap, estimated
  // from the residuals. If it is larger, the submap may be bent, so the initializer waits for more motion.
  double max_direction_sigma_rad = 0.03;
  // The largest error of the best structure, as a share of the error of another one that the two views allow (as on a
  // plane).
  double max_rival_rmse_ratio = 0.9;
  TwoViewOptions two_view;
};

}  // namespace rumi::front_tracker
