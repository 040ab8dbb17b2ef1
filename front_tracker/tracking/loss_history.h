// SPDX-License-Identifier: BSD-3-Clause
// How well the latest frames in the submap that is tracked were known: after a loss it says since when tracking had
// gone wrong.
#pragma once

#include <deque>
#include <vector>

#include "front_tracker/frame/front_submap.h"
#include "front_tracker/relocalization/relocalizer.h"

namespace rumi::front_tracker {

class LossHistory {
 public:
  // A frame with a pose in that submap, later than the last one.
  void add(const Frame& frame);
  void clear() { supports_.clear(); }

  // Is the scale lost faster than the pose would be worth anything? `max_drift`: of its logarithm in a second, standard
  // deviation.
  bool scale_drifts(const Frame& frame, double max_drift) const;

  // Just before a loss tracking may have slipped: then the same things lie at two places of the submap, where they were
  // seen long ago and where the last frames put them. So it is if the newest keyframes contradict where `found` was
  // found again. What came after the slip is taken out of the submap and forgotten here; returns its frames, in order
  // of time. None if nothing older would be left to hold on to.
  std::vector<int64_t> withdraw_slip(const Relocalizer& relocalizer, const Frame& found, FrontSubmap* submap);

 private:
  struct Support {
    int64_t utime_us = 0;
    int inliers = 0;
    double log_scale_variance = 0;  // see PoseCertainty
  };
  using Supports = std::deque<Support>;
  bool is_torn(const Relocalizer& relocalizer, const Submap& map, const Frame& found) const;
  Supports::const_iterator slip_begins() const;

  Supports supports_;
};

}  // namespace rumi::front_tracker
