// SPDX-License-Identifier: BSD-3-Clause
// Matching of binary descriptors, by brute force within a search region.
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "slam/map/submap.h"

namespace rumi {

struct MatchOptions {
  int max_distance = 60;       // Hamming, of 256 bits
  double max_ratio = 0.8;      // best over second best distance
  double max_shift_px = 0;     // between the two undistorted pixels; 0 = anywhere
  bool check_rotation = true;  // keep only the matches whose keypoints turned as most did
};

struct Match {
  int first = 0;  // indices into the two feature sets
  int second = 0;
  int distance = 0;
};

// Mutually best matches between the selected features (all if the selection is empty), in order of `first`.
std::vector<Match> match_features(const Features& first, const std::vector<int>& first_selection,
                                  const Features& second, const std::vector<int>& second_selection,
                                  const MatchOptions& options);

// Keeps the matches that fall into the three fullest of 30 bins of the difference in keypoint angle.
void keep_consistent_rotations(const Features& first, const Features& second, std::vector<Match>* matches);

}  // namespace rumi
