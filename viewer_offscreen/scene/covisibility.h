// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>
#include <vector>

#include "slam/map/submap.h"

namespace rumi::viewer_offscreen {

// Pairs of keyframe ids, the smaller one first, that observe at least min_shared landmarks in common. Quicker than
// Submap::covisible_keyframes for every keyframe: each landmark is looked at once.
std::vector<std::pair<int, int>> covisible_pairs(const Submap& submap, int min_shared);

}  // namespace rumi::viewer_offscreen
