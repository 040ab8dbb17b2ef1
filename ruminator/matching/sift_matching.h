// SPDX-License-Identifier: BSD-3-Clause
// Matches images that show the same things: compares all descriptors, then verifies the matches by an essential matrix.
#pragma once

#include <utility>
#include <vector>

#include "ruminator/matching/sift_features.h"

namespace rumi::ruminator {

constexpr int kMinInliers = 15;  // least number of inliers of a verified pair

using IndexPairs = std::vector<std::pair<int, int>>;

// Returns the mutually best matches among the first `limit` keypoints of each image (all if 0), in order of the first
// index.
IndexPairs match_sift(const SiftFeatures& first, const SiftFeatures& second, int limit = 0);
// Returns the matches that agree with one essential matrix, or an empty vector if they are fewer than kMinInliers.
// Deterministic.
IndexPairs verify_matches(const Camera& camera, const SiftFeatures& first, const SiftFeatures& second,
                          const IndexPairs& matches);

}  // namespace rumi::ruminator
