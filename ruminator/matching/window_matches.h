// SPDX-License-Identifier: BSD-3-Clause
// Matches the images of a window. The back process looks for matches in all pairs (paper, section IV.B), while the
// front process compares only neighbours in time and space.
#pragma once

#include <atomic>
#include <functional>
#include <vector>

#include "ruminator/matching/sift_matching.h"
#include "ruminator/matching/window_image.h"

namespace rumi::ruminator {

struct PairSelection {
  int near = 10;  // pairs at most this many images apart are matched completely
  int far = 10;   // most of the farther pairs, for each image, that are matched after a successful preview
};

// Returns the verified pairs, in order. If `cancel` becomes true, stops and returns the pairs found so far.
std::vector<ImagePair> match_window(const Camera& camera, const std::vector<SiftFeatures>& images,
                                    const PairSelection& selection,
                                    const std::function<void(double fraction)>& progress,
                                    const std::atomic<bool>& cancel);

// Returns the median motion of a pair's matches, in pixels, after the best rotation is removed; 0 without matches. A
// parallax below the error of the keypoints says nothing about depth.
double parallax_px(const Camera& camera, const std::vector<SiftFeatures>& images, const ImagePair& pair);

// Groups the images that are connected by pairs with at least `min_matches` matches. Returns the group number of each
// image; 0 is the largest group, and single images are groups too.
std::vector<int> connected_images(int images, const std::vector<ImagePair>& pairs, int min_matches);

}  // namespace rumi::ruminator
