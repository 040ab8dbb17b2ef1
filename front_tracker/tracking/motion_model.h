// SPDX-License-Identifier: BSD-3-Clause
// Where the camera was last, how it moved, and so where it should be now: what it did between the last two frames goes
// on.
#pragma once

#include "front_tracker/frame/frame.h"

namespace rumi::front_tracker {

class MotionModel {
 public:
  // The last frame with a pose.
  const Frame& last() const { return last_; }
  // False: the last frame was not tracked from the one before it.
  bool is_known() const { return interval_us_ > 0; }

  // The frame was tracked from the last one.
  void go_on(Frame frame);
  // The frame was found without the last one, which may be of another submap.
  void begin_at(Frame frame);
  // Brings the last frame to where mapping has moved its keyframe since.
  void follow_mapping(const Submap& map);

  // cam_from_submap at that time; where the motion is not known, that of the last frame.
  SE3 predict(int64_t utime_us) const;
  // How far the frame's landmarks moved in the image since the last frame: median, of the image's width.
  double image_motion(const Submap& map, const Frame& frame) const;

 private:
  Frame last_;
  SE3 this_cam_from_last_cam_;  // of the last two frames
  int64_t interval_us_ = 0;     // between them
};

}  // namespace rumi::front_tracker
