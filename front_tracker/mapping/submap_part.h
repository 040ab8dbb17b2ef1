// SPDX-License-Identifier: BSD-3-Clause
// Submaps of bounded size: when a front submap is full, tracking goes on in a new one, which begins as a copy of the
// part around the camera. Ids, poses and positions stay as they are, so nothing that tracking knows has to change, and
// the images that both submaps have in common join them exactly.
#pragma once

#include <memory>

#include "front_tracker/frame/front_submap.h"

namespace rumi::front_tracker {

// Returns the front submap `key`, which begins with the frame `utime_us`, its reference keyframe, and the keyframes
// that share most landmarks with that, `keyframes` in all. It has the landmarks that at least two of them observe.
// Moves the images of the latest keyframes into it. The submap must have the frame.
std::unique_ptr<FrontSubmap> go_on_from(FrontSubmap& full, SubmapKey key, int64_t utime_us, size_t keyframes);

}  // namespace rumi::front_tracker
