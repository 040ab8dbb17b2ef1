// SPDX-License-Identifier: BSD-3-Clause
// Predicts the next pose: the motion between the last two frames goes on.
#pragma once

#include "front_tracker/frame/frame.h"

namespace rumi::front_tracker {

class MotionModel {
 public:
  // Returns the last frame with a pose.
  const Frame& last() const { return last_; }
  // False if the last frame was not tracked from the one before it.
  bool is_known() const { return interval_us_ > 0; }

  // Takes a frame that was tracked from the last one.
  void go_on(Frame frame);
  // Takes a frame that was found without the last one, which may belong to another submap.
  void begin_at(Frame frame);
  // Moves the last frame along with its reference keyframe, which mapping may have moved.
  void follow_mapping(const Submap& map);

  // Returns the predicted cam_from_submap at a time. If the motion is not known, returns the last frame's pose.
  SE3 predict(int64_t utime_us) const;
  // Returns the median motion of the frame's landmarks in the image since the last frame, as a share of its width.
  double image_motion(const Submap& map, const Frame& frame) const;

 private:
  Frame last_;
  SE3 this_cam_from_last_cam_;  // motion between the last two frames
  int64_t interval_us_ = 0;     // time between them
};

}  // namespace rumi::front_tracker
