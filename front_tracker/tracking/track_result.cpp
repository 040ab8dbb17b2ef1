// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/tracking/track_result.h"

namespace rumi::front_tracker {

void note_pose(const FrontSubmap& submap, const Frame& frame, TrackResult* result) {
  result->submap_id = submap.map.key.id;
  result->submap_revision = submap.map.revision;
  result->reference_keyframe = frame.reference_keyframe;
  result->cam_from_keyframe = frame.cam_from_keyframe;
  result->cam_from_submap = frame.cam_from_submap;
  result->sigmas = submap.map.frame(frame.utime_us)->sigmas;
  result->inliers = frame.matches();
}

std::vector<TrackResult> results_afterwards(const FrontSubmap& submap, const std::vector<Frame>& frames) {
  std::vector<TrackResult> results;
  for (const Frame& frame : frames) {
    TrackResult& result = results.emplace_back();
    result.utime_us = frame.utime_us;
    result.keypoints = static_cast<int>(frame.features->size());
    result.is_keyframe = submap.map.keyframe(frame.reference_keyframe)->utime_us == frame.utime_us;
    note_pose(submap, frame, &result);
  }
  return results;
}

}  // namespace rumi::front_tracker
