// SPDX-License-Identifier: BSD-3-Clause
// The part of the submap that surrounds a frame.
#pragma once

#include <vector>

#include "front_tracker/frame/frame.h"

namespace rumi::front_tracker {

struct LocalMap {
  int reference_keyframe = kNone;          // keyframe that shares the most landmarks with the frame
  std::vector<const Landmark*> landmarks;  // in order of id, without the frame's matches
};

// Collects the landmarks of the keyframes that share the most with the frame, and of their neighbours, from at most
// `keyframes` keyframes. If no keyframe shares a landmark, the reference stays that of the frame.
LocalMap local_map(const Submap& map, const Frame& frame, int keyframes);

}  // namespace rumi::front_tracker
