// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>
#include <vector>

#include "slam/map/submap.h"

namespace rumi::viewer_offscreen {

// Returns the pairs of keyframe ids, the smaller one first, that observe at least min_shared landmarks in common. It
// looks at each landmark once, and is quicker than Submap::covisible_keyframes() for every keyframe.
std::vector<std::pair<int, int>> covisible_pairs(const Submap& submap, int min_shared);

}  // namespace rumi::viewer_offscreen
