// SPDX-License-Identifier: BSD-3-Clause
// The support of the latest frames of the active submap: how many landmarks each had as inliers, and how well the scale
// was known.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "front_tracker/frame/frame.h"

namespace rumi::front_tracker {

class SupportHistory {
 public:
  // Adds a frame that has a pose in the active submap and is later than the last one. Forgets frames that are more than
  // four seconds older, and all but the latest kMostRetoldFrames.
  void add(const Frame& frame);
  void clear() { supports_.clear(); }

  // True if the variance of the log scale has grown by more than max_drift^2 within the last second.
  bool scale_drifts(const Frame& frame, double max_drift) const;

  // Returns the time of the oldest frame; nullopt if there is none.
  std::optional<int64_t> begin_us() const;
  // Returns the time at which the support became weak: that of the frame with the fewest inliers, or of the first of
  // those just before it that had less than twice as many. There must be a frame.
  int64_t weak_since_us() const;
  void forget_from(int64_t utime_us);

 private:
  struct Support {
    int64_t utime_us = 0;
    int inliers = 0;
    double log_scale_variance = 0;  // see PoseCertainty
  };
  std::deque<Support> supports_;
};

}  // namespace rumi::front_tracker
