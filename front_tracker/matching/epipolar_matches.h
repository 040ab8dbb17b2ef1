// SPDX-License-Identifier: BSD-3-Clause
// Matches keypoints that are no landmarks between a frame and an earlier one. In a turn, or in front of a scene that
// has just come into view, there are hundreds of them and few landmarks. They determine the rotation and the direction
// of the motion.
#pragma once

#include "front_tracker/frame/frame.h"

namespace rumi::front_tracker {

// A frame or a keyframe with a pose.
struct EarlierView {
  std::shared_ptr<const Features> features;
  const std::vector<int>& landmark_ids;  // for each keypoint; kNone if it has no match
  SE3 cam_from_submap;
};

// Returns the keypoints of the earlier view that are found again in the frame, without those that are landmarks in
// both.
EpipolarView match_epipolar(const Camera& camera, const std::vector<double>& octave_scales, const EarlierView& earlier,
                            const Frame& frame);

// Returns how many of these matches agree with the pose.
size_t count_agreeing(const Camera& camera, const SE3& cam_from_submap, const EpipolarView& view);

}  // namespace rumi::front_tracker
