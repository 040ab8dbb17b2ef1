// SPDX-License-Identifier: BSD-3-Clause
// Matches landmarks that another image observes to a frame's keypoints by their descriptors alone, for when no pose
// says where to look.
#pragma once

#include <utility>
#include <vector>

#include "front_tracker/frame/frame.h"

namespace rumi::front_tracker {

// The two vectors have the same order.
struct LandmarkMatches {
  std::vector<PointObservation> observations;  // for slam/optimization/resection.h
  std::vector<std::pair<int, int>> pairs;      // keypoint of the frame, landmark
};

// `features` and `landmark_ids` (one for each keypoint) are those of the other image. Each keypoint is matched at most
// once, and only if it is much more alike than the next one.
LandmarkMatches match_by_brute_force(const Submap& submap, const std::vector<double>& octave_scales,
                                     const Features& features, const std::vector<int>& landmark_ids, const Frame& frame,
                                     int max_distance);

// Makes the pairs that agree with the pose the frame's matches.
void take_inliers(const LandmarkMatches& matches, const std::vector<bool>& inlier, Frame* frame);

}  // namespace rumi::front_tracker
