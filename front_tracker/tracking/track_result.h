// SPDX-License-Identifier: BSD-3-Clause
// The tracker's result for an image.
#pragma once

#include <vector>

#include "front_tracker/frame/front_submap.h"
#include "slam/map/tracking_state.h"

namespace rumi::front_tracker {

struct TrackResult {
  int64_t utime_us = 0;
  TrackingState state = TrackingState::kNotInitialized;
  int submap_id = kNoSubmap;  // kNoSubmap if the image has no pose
  int64_t submap_revision = 0;
  int reference_keyframe = kNone;
  SE3 cam_from_keyframe, cam_from_submap;
  PoseSigmas sigmas;
  bool is_keyframe = false;
  int keypoints = 0, inliers = 0;
};

// Copies the frame's pose, as the submap has it, into the result.
void note_pose(const FrontSubmap& submap, const Frame& frame, TrackResult* result);
// Returns the results of earlier frames that got their poses only now.
std::vector<TrackResult> results_afterwards(const FrontSubmap& submap, const std::vector<Frame>& frames);

}  // namespace rumi::front_tracker
