// SPDX-License-Identifier: BSD-3-Clause
// What a frame sees again of an earlier one although it is no landmark: hundreds of keypoints where few landmarks are
// left, in a turn or in front of what has just come into view. They hold the rotation and the direction of the motion.
#pragma once

#include "front_tracker/frame/frame.h"

namespace rumi::front_tracker {

// A frame, or a keyframe, with a pose.
struct EarlierView {
  std::shared_ptr<const Features> features;
  const std::vector<int>& landmark_ids;  // per keypoint, kNone where nothing is matched
  SE3 cam_from_submap;
};

// The keypoints of the earlier view that are found again in the frame, but those that are landmarks in both.
EpipolarView match_epipolar(const Camera& camera, const std::vector<double>& octave_scales, const EarlierView& earlier,
                            const Frame& frame);

// Of these, how many agree with the frame's pose.
size_t count_agreeing(const Camera& camera, const SE3& cam_from_submap, const EpipolarView& view);

}  // namespace rumi::front_tracker
