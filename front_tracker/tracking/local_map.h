// SPDX-License-Identifier: BSD-3-Clause
// What of the submap is around a frame.
#pragma once

#include <vector>

#include "front_tracker/frame/frame.h"

namespace rumi::front_tracker {

struct LocalMap {
  int reference_keyframe = kNone;          // that shares most with the frame
  std::vector<const Landmark*> landmarks;  // by their ids; without those that the frame is matched to
};

// Of the keyframes, at most so many, that share most with the frame, and of their neighbours. The reference stays the
// frame's where it shares nothing with any.
LocalMap local_map(const Submap& map, const Frame& frame, int keyframes);

}  // namespace rumi::front_tracker
