// SPDX-License-Identifier: BSD-3-Clause
// Matches landmarks that another image observes to a frame's keypoints by their descriptors alone, for when no pose
// says where to look.
#pragma once

#include <utility>
#include <vector>

#include "front_tracker/frame/frame.h"

namespace rumi::front_tracker {

// Element i of both vectors belongs to the same match.
struct LandmarkMatches {
  std::vector<PointObservation> observations;  // input of resect()
  std::vector<std::pair<int, int>> pairs;      // keypoint of the frame, and landmark id
};

// `features` and `landmark_ids` (by keypoint) are those of the other image. Each keypoint is matched at most once, and
// only if the best match is much more similar than the second.
LandmarkMatches match_by_brute_force(const Submap& submap, const std::vector<double>& octave_scales,
                                     const Features& features, const std::vector<int>& landmark_ids, const Frame& frame,
                                     int max_distance);

// Stores the pairs that are inliers as matches of the frame.
void take_inliers(const LandmarkMatches& matches, const std::vector<bool>& inlier, Frame* frame);

}  // namespace rumi::front_tracker
