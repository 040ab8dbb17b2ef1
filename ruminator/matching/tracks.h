// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>
#include <vector>

#include "ruminator/matching/window_image.h"

namespace rumi::ruminator {

// One thing seen in several images: (image, keypoint), at most one per image, in order of image.
using Track = std::vector<std::pair<int, int>>;

// Joins the matches of all pairs to tracks, in order of their first observation. The pairs with the most matches go
// first. A match that would bring two keypoints of one image into a track is left out, because something in it is
// wrong.
std::vector<Track> join_tracks(const std::vector<WindowImage>& images, const std::vector<ImagePair>& pairs);

}  // namespace rumi::ruminator
