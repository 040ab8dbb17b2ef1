// SPDX-License-Identifier: BSD-3-Clause
// Brute-force matching of binary descriptors within a search region.
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "slam/features/features.h"

namespace rumi {

// The nearest of the candidates for one descriptor, and how near the next one is.
struct BestMatch {
  int distance = 257, second_distance = 257;  // Hamming; 257: none
  int index = kNone;
  void offer(int offered_distance, int offered_index) {
    if (offered_distance < distance) {
      second_distance = distance;
      distance = offered_distance;
      index = offered_index;
    } else if (offered_distance < second_distance) {
      second_distance = offered_distance;
    }
  }
};

struct MatchOptions {
  int max_distance = 60;       // Hamming, of 256 bits
  double max_ratio = 0.8;      // best over second best distance
  bool check_rotation = true;  // keep only the matches whose keypoints turned as most others did
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
