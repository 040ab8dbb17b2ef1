// SPDX-License-Identifier: BSD-3-Clause
// Matches images that show the same things: descriptors by brute force, then verified by an essential matrix.
#pragma once

#include <utility>
#include <vector>

#include "ruminator/matching/sift_features.h"

namespace rumi::ruminator {

constexpr int kMinInliers = 15;  // a verified pair has so many

using IndexPairs = std::vector<std::pair<int, int>>;

// Returns the mutually best matches among the first `limit` keypoints of either (all if 0), in order of the first
// index.
IndexPairs match_sift(const SiftFeatures& first, const SiftFeatures& second, int limit = 0);
// Returns the matches that agree with one essential matrix; none if fewer than kMinInliers do. Deterministic.
IndexPairs verify_matches(const Camera& camera, const SiftFeatures& first, const SiftFeatures& second,
                          const IndexPairs& matches);

}  // namespace rumi::ruminator
