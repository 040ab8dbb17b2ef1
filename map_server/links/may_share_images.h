// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slam/map/submap.h"

namespace rumi::map_server {

// Compares streams and times only, which is quick. If it returns false, the two submaps have no image in common.
inline bool may_share_images(const Submap& a, const Submap& b) {
  return a.stream == b.stream && !a.frames.empty() && !b.frames.empty() &&
         a.frames.begin()->first <= b.frames.rbegin()->first && b.frames.begin()->first <= a.frames.rbegin()->first;
}

}  // namespace rumi::map_server
