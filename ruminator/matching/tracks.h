// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>
#include <vector>

#include "ruminator/matching/window_image.h"

namespace rumi::ruminator {

// One thing seen in several images: (image, keypoint), at most one per image, in order of image.
using Track = std::vector<std::pair<int, int>>;

// The matches of all pairs joined. Those of the pairs with the most matches go first; one that would bring two
// keypoints of an image into a track is wrong somewhere and left out. In order of the first observation.
std::vector<Track> join_tracks(const std::vector<WindowImage>& images, const std::vector<ImagePair>& pairs);

}  // namespace rumi::ruminator
