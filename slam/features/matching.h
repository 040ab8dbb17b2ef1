// SPDX-License-Identifier: BSD-3-Clause
// Brute-force matching of binary descriptors.
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "slam/features/features.h"

namespace rumi {

// The nearest of the candidates for one descriptor, and the distance of the second nearest.
struct BestMatch {
  int distance = 257, second_distance = 257;  // Hamming; 257 if there is none
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
  int max_distance = 60;       // Hamming distance of a match (of 256 bits), at most
  double max_ratio = 0.8;      // best distance / second best distance, at most
  bool check_rotation = true;  // keep only matches whose keypoints turned as most others did
};

struct Match {
  int first = 0;  // indices into the two feature sets
  int second = 0;
  int distance = 0;
};

// Returns the mutually best matches of the selected features, in the order of the first selection. An empty selection
// stands for all features.
std::vector<Match> match_features(const Features& first, const std::vector<int>& first_selection,
                                  const Features& second, const std::vector<int>& second_selection,
                                  const MatchOptions& options);

// Keeps the matches in the fullest of 30 bins of the difference in keypoint angle, and in the second and third fullest
// if they hold at least a tenth as many.
void keep_consistent_rotations(const Features& first, const Features& second, std::vector<Match>* matches);

}  // namespace rumi
