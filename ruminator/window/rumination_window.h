// SPDX-License-Identifier: BSD-3-Clause
// A rumination window: frames that are rebuilt together. A window by time has the frames around a tracking loss, which
// are S = S1 + S2 + S3 in the paper, section IV.B. A window by place (ruminator/again) has frames that look alike, all
// in `gap`.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "slam/geometry/transform.h"
#include "slam/map/submap.h"

namespace rumi::ruminator {

// In place of a submap's id: the pose is that in the map. Only windows by place have such samples.
inline constexpr int32_t kMapFrame = std::numeric_limits<int32_t>::min();

struct Sample {
  int64_t utime_us = 0;
  bool is_keyframe = false;       // of front_tracker, or of any submap in the map if submap_id is kMapFrame
  int32_t submap_id = kNoSubmap;  // the submap in which front_tracker tracked it, or kMapFrame
  SE3 cam_from_submap = {};       // valid if submap_id is set
};

struct RuminationWindow {
  int32_t id = 0;  // 1, 2, 3, ... within the session; the id of its back submap is -id
  int64_t session = 0;
  int64_t stream = 0;  // the stream of its images
  int32_t submap_before = kNoSubmap, submap_after = kNoSubmap;
  int64_t lost_utime_us = 0;
  int64_t resumed_utime_us = 0;                  // 0 while tracking is lost
  std::vector<Sample> approach, gap, departure;  // S1, S2, S3, each in order of time
  bool by_place = false;
  int gap_frames = 0;  // all frames of the gap, also those thinned out or without an image
  std::string reason;  // why the window ended before it was complete; may be empty

  // Returns all samples, in order of time.
  std::vector<Sample> samples() const {
    std::vector<Sample> all;
    for (const auto* part : {&approach, &gap, &departure}) all.insert(all.end(), part->begin(), part->end());
    return all;
  }
};

}  // namespace rumi::ruminator
