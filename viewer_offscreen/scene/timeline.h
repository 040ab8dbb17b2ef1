// SPDX-License-Identifier: BSD-3-Clause
// The timeline says what became of the frames of a recording over time.
#pragma once

#include <cstdint>
#include <vector>

#include "slam/map/submap.h"

namespace rumi::viewer_offscreen {

// The note of what front_tracker said of a frame when it saw it.
struct FrameNote {
  int64_t utime_us = 0;
  int8_t state = kUnknownState;  // as in track_t
  SubmapKey submap = {};         // the submap in which it was tracked
  static constexpr int8_t kUnknownState = -1;
};

// Consecutive frames that share a fate.
struct TimelineSpan {
  int64_t first_us = 0, last_us = 0;
  int8_t state = FrameNote::kUnknownState;  // as in track_t
  int submap = -1;                          // index in Scene::submaps; -1: none
};

// Consecutive frames that have a pose in no submap.
struct LostSpan {
  int64_t first_us = 0, last_us = 0;
  int64_t frames = 0;
};

struct Timeline {
  std::vector<TimelineSpan> tracked;  // how frames were tracked when they came
  std::vector<TimelineSpan> in_map;   // where frames are in the map now; `state` has no meaning
  int64_t filled = 0;                 // frames in the map by a back submap alone
  int64_t end_us = 0;                 // of the last frame, its duration included
};

// The submap (index in Scene::submaps, or -1) that each of `frames` was tracked in and that holds its pose in the map.
Timeline make_timeline(const std::vector<FrameNote>& frames, const std::vector<int>& tracked_in,
                       const std::vector<int>& placed_in);

// `posed`: whether each frame has a pose in any submap.
std::vector<LostSpan> find_lost(const std::vector<FrameNote>& frames, const std::vector<bool>& posed);

}  // namespace rumi::viewer_offscreen
