// SPDX-License-Identifier: BSD-3-Clause
// Proves that the scene has depth: a model is published only if pairs of its images show that.
#pragma once

#include <atomic>
#include <set>
#include <vector>

#include "base/result.h"
#include "ruminator/matching/sift_features.h"
#include "ruminator/matching/window_image.h"

namespace rumi::ruminator {

// Returns an Error unless at least three of the images in `which` belong to pairs that show depth. For each image, the
// pairs farthest apart in time and the pair with the largest parallax are tested. `pairs`: verified matches. Returns no
// Error if it is cancelled.
Result<> prove_depth(const Camera& camera, const std::vector<SiftFeatures>& images, const std::vector<ImagePair>& pairs,
                     const std::set<int>& which, const std::atomic<bool>& cancel);

}  // namespace rumi::ruminator
