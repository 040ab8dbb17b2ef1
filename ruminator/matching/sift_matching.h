// SPDX-License-Identifier: BSD-3-Clause
// Pairs of images that show the same things: descriptors matched by brute force, then verified by an essential matrix.
#pragma once

#include <utility>
#include <vector>

#include "ruminator/matching/sift_features.h"

namespace rumi::ruminator {

constexpr int kMinInliers = 15;  // of a verified pair

using IndexPairs = std::vector<std::pair<int, int>>;

// Mutually best matches among the first `limit` keypoints of either (all if 0), in order of the first index.
IndexPairs match_sift(const SiftFeatures& first, const SiftFeatures& second, int limit = 0);
// Those that agree with one essential matrix; none if fewer than kMinInliers do. Deterministic.
IndexPairs verify_matches(const Camera& camera, const SiftFeatures& first, const SiftFeatures& second,
                          const IndexPairs& matches);

}  // namespace rumi::ruminator
