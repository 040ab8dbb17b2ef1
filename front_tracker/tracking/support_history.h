// SPDX-License-Identifier: BSD-3-Clause
// How well the latest frames of the active submap were known: how many landmarks supported each, and how well the scale
// was known.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "front_tracker/frame/frame.h"

namespace rumi::front_tracker {

class SupportHistory {
 public:
  // Adds a frame that has a pose in the active submap and is later than the last one. Frames of more than the last four
  // seconds are forgotten.
  void add(const Frame& frame);
  void clear() { supports_.clear(); }

  // True if the standard deviation of log scale grows by more than `max_drift` per second.
  bool scale_drifts(const Frame& frame, double max_drift) const;

  // The time of the oldest frame; nullopt if there is none.
  std::optional<int64_t> begin_us() const;
  // The time at which support became weak: that of the frame with the fewest inliers, or of one just before it that had
  // hardly more. There must be a frame.
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
