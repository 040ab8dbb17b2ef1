// SPDX-License-Identifier: BSD-3-Clause
// Matches keypoints without landmarks between a frame and an earlier one. In a turn, or if a scene has just come into
// view, there are hundreds of these but few landmarks. They determine the rotation and the direction of the motion.
#pragma once

#include "front_tracker/frame/frame.h"

namespace rumi::front_tracker {

// A frame or a keyframe with a pose.
struct EarlierView {
  std::shared_ptr<const Features> features;
  const std::vector<int>& landmark_ids;  // by keypoint; kNone if it has no match
  SE3 cam_from_submap;
};

// Returns the matches of the earlier view with the frame, without those that are landmarks in both.
EpipolarView match_epipolar(const Camera& camera, const std::vector<double>& octave_scales, const EarlierView& earlier,
                            const Frame& frame);

// Returns how many of these matches agree with the pose.
size_t count_agreeing(const Camera& camera, const SE3& cam_from_submap, const EpipolarView& view);

}  // namespace rumi::front_tracker
