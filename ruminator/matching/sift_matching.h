// SPDX-License-Identifier: BSD-3-Clause
// Pairs of images that show the same things: descriptors matched by brute force, then verified by an essential matrix.
#pragma once

#include <utility>
#include <vector>

#include "ruminator/matching/sift_features.h"

namespace rumi::ruminator {

struct SiftMatchOptions {
  double max_ratio = 0.8;     // distance of the best over the second best
  double max_distance = 0.7;  // of unit vectors
  // A pair that is not near in time is looked at more closely only if its `preview_keypoints` of the largest scale have
  // `preview_matches` (Wu, "Towards linear-time incremental structure from motion", 3DV 2013).
  int preview_keypoints = 150;
  int preview_matches = 6;
  int min_matches = 20;   // of a pair, for it to be verified
  int iterations = 1000;  // RANSAC, at most
  // Distance from both epipolar lines, sqrt(d1² + d2²).
  double max_error_px = 1.5;
  int min_inliers = 15;
};

using IndexPairs = std::vector<std::pair<int, int>>;

// Mutually best matches among the first `limit` keypoints of either (all if 0), in order of the first index.
IndexPairs match_sift(const SiftFeatures& first, const SiftFeatures& second, const SiftMatchOptions& options,
                      int limit = 0);
// Those that agree with one essential matrix; none if fewer than min_inliers do. Deterministic.
IndexPairs verify_matches(const Camera& camera, const SiftFeatures& first, const SiftFeatures& second,
                          const IndexPairs& matches, const SiftMatchOptions& options);

}  // namespace rumi::ruminator
