// SPDX-License-Identifier: BSD-3-Clause
// A model is published only if pairs of its images prove that the scene has depth.
#pragma once

#include <atomic>
#include <set>
#include <vector>

#include "base/result.h"
#include "ruminator/matching/sift_features.h"
#include "ruminator/matching/window_image.h"

namespace rumi::ruminator {

// An Error unless three of the images in `which` take part in pairs that show depth. For each image it tests the pairs
// that are farthest apart and the pair with the most parallax. `pairs`: verified matches. No Error if it is cancelled.
Result<> prove_depth(const Camera& camera, const std::vector<SiftFeatures>& images, const std::vector<ImagePair>& pairs,
                     const std::set<int>& which, const std::atomic<bool>& cancel);

}  // namespace rumi::ruminator
