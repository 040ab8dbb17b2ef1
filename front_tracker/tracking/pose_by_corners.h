// SPDX-License-Identifier: BSD-3-Clause
// Finds a frame's pose from its corners: short-term association with the last frame, then mid-term association with the
// landmarks nearby (equation 5 of the paper).
#pragma once

#include <string>

#include "front_tracker/frame/front_submap.h"
#include "front_tracker/frame/tracking_options.h"
#include "front_tracker/patches/patch_templates.h"
#include "front_tracker/tracking/found_pose.h"
#include "front_tracker/tracking/motion_model.h"

namespace rumi::front_tracker {

class PoseByCorners {
 public:
  explicit PoseByCorners(const TrackingOptions& options) : options_(options) {}

  // The frame must have features. If no pose is found, it keeps the keypoints that were moved or added meanwhile.
  FoundPose find(const FrontSubmap& submap, const MotionModel& motion, Frame frame, PatchTemplates* templates) const;

 private:
  // The inputs that all steps share.
  struct Place {
    const FrontSubmap& submap;
    const MotionModel& motion;
    PatchTemplates* templates;
  };
  bool match_last_frame(const Place& place, Frame* frame) const;
  bool match_regardless_of_place(const Place& place, Frame* frame) const;
  int match_local_map(const Place& place, FoundPose* pose) const;
  bool patches_may_help(const Place& place, const Frame& frame, int inliers) const;
  std::string doubt(const Place& place, Frame* frame) const;
  int support_by_epipolar_matches(const Place& place, Frame* frame) const;

  TrackingOptions options_;
};

}  // namespace rumi::front_tracker
