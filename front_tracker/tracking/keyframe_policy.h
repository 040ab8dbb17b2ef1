// SPDX-License-Identifier: BSD-3-Clause
// Decides when a tracked frame becomes a keyframe.
#pragma once

#include "front_tracker/frame/frame.h"
#include "front_tracker/tracking/keyframe_options.h"

namespace rumi::front_tracker {

class KeyframePolicy {
 public:
  // `keypoints`: the number of keypoints that an image should have.
  KeyframePolicy(const KeyframeOptions& options, int keypoints) : options_(options), keypoints_(keypoints) {}

  void note_keyframe(int64_t utime_us) { last_keyframe_us_ = utime_us; }
  // Notes that the camera was found again after it was LOST.
  void note_found_again(int64_t utime_us) { found_again_us_ = utime_us; }

  // True if the frame should become a keyframe. `motion`: median motion of the image since the last frame / its width.
  bool is_due(const Submap& map, const Frame& frame, double motion) const;

 private:
  KeyframeOptions options_;
  int keypoints_;
  int64_t last_keyframe_us_ = 0;
  int64_t found_again_us_ = INT64_MIN / 2;
};

}  // namespace rumi::front_tracker
