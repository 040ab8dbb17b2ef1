// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <utility>

#include "map_server/atlas/atlas.h"

namespace rumi::map_server {

// Returns the frames of sessions later than `after`, ordered by session and time.
inline std::map<std::pair<int64_t, ImageId>, const FrameRecord*> frames_by_session(const Atlas& atlas, int64_t after) {
  std::map<std::pair<int64_t, ImageId>, const FrameRecord*> frames;
  for (const auto& [image, record] : atlas.frames())
    if (record.session > after) frames.emplace(std::pair(record.session, image), &record);
  return frames;
}

}  // namespace rumi::map_server
