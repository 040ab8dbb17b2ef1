// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace rumi::front_tracker {

struct KeyframeOptions {
  double min_tracked_ratio = 0.7;     // inliers / established landmarks of the reference keyframe, below which a
                                      // keyframe is due
  double urgent_tracked_ratio = 0.6;  // as min_tracked_ratio; below it a keyframe is due at once, whatever the interval
                                      // since the last one
  double max_motion = 0.03;           // median motion between two frames, as a share of the width, above which a
                                      // keyframe is due
  double min_interval_s = 0.09;
  double max_interval_s = 1.0;
  int min_inliers = 100;  // inliers of a frame below which a keyframe is due sooner
};

}  // namespace rumi::front_tracker
