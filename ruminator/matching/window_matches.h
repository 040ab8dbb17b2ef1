// SPDX-License-Identifier: BSD-3-Clause
// Matches the images of a window. The back process looks at all pairs (paper, section IV.B), while the front one looks
// only at neighbours in time and place.
#pragma once

#include <atomic>
#include <functional>
#include <vector>

#include "ruminator/matching/sift_matching.h"
#include "ruminator/matching/window_image.h"

namespace rumi::ruminator {

struct PairSelection {
  int near = 10;  // pairs at most so many images apart are matched in full
  int far = 10;   // of the farther pairs in which a preview finds matches, the best ones of each image are matched
};

// Returns the verified pairs, in order. If `cancel` is set, it stops and returns those that it has.
std::vector<ImagePair> match_window(const Camera& camera, const std::vector<SiftFeatures>& images,
                                    const PairSelection& selection,
                                    const std::function<void(double fraction)>& progress,
                                    const std::atomic<bool>& cancel);

// Returns the median motion of the matches of a pair, in pixels, beyond what a turn of the camera explains. A parallax
// below the error of the keypoints says nothing about depth. 0 without matches.
double parallax_px(const Camera& camera, const std::vector<SiftFeatures>& images, const ImagePair& pair);

// Groups the images that hang together over pairs of at least `min_matches`. Returns the group of each image; groups
// are numbered from the largest on, those of one image included.
std::vector<int> connected_images(int images, const std::vector<ImagePair>& pairs, int min_matches);

}  // namespace rumi::ruminator
