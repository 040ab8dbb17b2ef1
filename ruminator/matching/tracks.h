// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>
#include <vector>

#include "ruminator/matching/window_image.h"

namespace rumi::ruminator {

// A point seen in several images: (image, keypoint), at most one per image, ordered by image.
using Track = std::vector<std::pair<int, int>>;

// Joins the matches of all pairs to tracks, which it returns in order of their first observation. The pairs with most
// matches are joined first. A match that would bring two keypoints of one image into a track is left out, because
// something in that track must be wrong.
std::vector<Track> join_tracks(const std::vector<WindowImage>& images, const std::vector<ImagePair>& pairs);

}  // namespace rumi::ruminator
