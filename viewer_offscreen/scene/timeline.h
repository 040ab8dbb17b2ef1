// SPDX-License-Identifier: BSD-3-Clause
// The timeline shows how the frames of a recording were tracked over time, and where they are in the map.
#pragma once

#include <cstdint>
#include <vector>

#include "slam/map/submap.h"

namespace rumi::viewer_offscreen {

// The report of front_tracker on a frame when it came.
struct FrameNote {
  int64_t utime_us = 0;
  int8_t state = kUnknownState;  // a state of track_t
  SubmapKey submap = {};         // the submap in which it was tracked
  static constexpr int8_t kUnknownState = -1;
};

// Consecutive frames with the same state and submap.
struct TimelineSpan {
  int64_t first_us = 0, last_us = 0;
  int8_t state = FrameNote::kUnknownState;  // a state of track_t
  int submap = -1;                          // index in Scene::submaps; -1: in no submap
};

// Consecutive frames that have no pose in any submap.
struct LostSpan {
  int64_t first_us = 0, last_us = 0;
  int64_t frames = 0;
};

struct Timeline {
  std::vector<TimelineSpan> tracked;  // how frames were tracked when they came
  std::vector<TimelineSpan> in_map;   // where frames are in the map now; `state` has no meaning
  int64_t filled = 0;                 // frames that only a back submap has in the map
  int64_t end_us = 0;                 // end of the last frame, with its duration
};

// `tracked_in`, `placed_in`: for each of `frames`, the submap (index in Scene::submaps, or -1) in which it was tracked,
// and the one that holds its pose in the map.
Timeline make_timeline(const std::vector<FrameNote>& frames, const std::vector<int>& tracked_in,
                       const std::vector<int>& placed_in);

// `posed`: for each of `frames`, whether it has a pose in any submap.
std::vector<LostSpan> find_lost(const std::vector<FrameNote>& frames, const std::vector<bool>& posed);

}  // namespace rumi::viewer_offscreen
