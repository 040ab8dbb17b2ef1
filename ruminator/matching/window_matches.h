// SPDX-License-Identifier: BSD-3-Clause
// What the images of a window have in common. The back process looks at all pairs (paper, section IV.B), where the
// front one looks at its neighbourhood in time and place only.
#pragma once

#include <atomic>
#include <functional>
#include <vector>

#include "ruminator/matching/sift_matching.h"
#include "ruminator/matching/window_image.h"

namespace rumi::ruminator {

struct PairSelection {
  int near = 10;  // images apart: matched in full; farther pairs only if the preview finds something,
  int far = 10;   // and of those the best of each image
};

// The verified pairs, in order. Stops early, with what it has, when `cancel` is set.
std::vector<ImagePair> match_window(const Camera& camera, const std::vector<SiftFeatures>& images,
                                    const PairSelection& selection,
                                    const std::function<void(double fraction)>& progress,
                                    const std::atomic<bool>& cancel);

// How far the matches of a pair move apart, in pixels, beyond what a turn of the camera explains: the median. Less than
// the keypoints' error, and nothing can be said of depth. 0 without matches.
double parallax_px(const Camera& camera, const std::vector<SiftFeatures>& images, const ImagePair& pair);

// The images that hang together over pairs of at least `min_matches`: the index of its group for each image, groups
// numbered from the largest, those of one image included.
std::vector<int> connected_images(int images, const std::vector<ImagePair>& pairs, int min_matches);

}  // namespace rumi::ruminator
