// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slam/geometry/two_view.h"

namespace rumi::front_tracker {

struct InitializerOptions {
  int keypoints = 2000;   // per image while there is no submap to track
  int min_matches = 100;  // with the reference image; fewer: a later reference
  int max_frames = 120;   // buffered; they get their poses once the submap stands
  int max_keyframes = 6;  // of the first bundle adjustment
  double min_motion_px =
      4.5;  // median, beyond what a rotation explains, for images 640 px wide; less: nothing is tried
  double accept_parallax_deg = 2.5;  // median, at which the first good pair is taken at once
  double min_parallax_deg = 1.75;  // below it a pair is refused; between the two it is taken if no better one can come
  double max_rmse_px = 1.2;        // after the first bundle adjustment
  // Motion beyond a rotation over that error, for images narrower than 640 px less by the square; less: more motion is
  // waited for.
  double min_motion_to_rmse = 10;
  double max_rival_rmse_ratio = 0.9;  // of the two best structures' errors, where two views allow two (a plane does)
  TwoViewOptions two_view;
};

}  // namespace rumi::front_tracker
