// SPDX-License-Identifier: BSD-3-Clause
// Finds a frame's pose without detecting corners: in slow motion, soon after an image with corners, the last frame's
// landmarks are found again by the patches around them.
//
// Such a frame cannot become a keyframe. So corners are also detected again once the images without them have moved so
// far that a keyframe is due.
#pragma once

#include <memory>
#include <string>

#include "front_tracker/frame/front_submap.h"
#include "front_tracker/frame/tracking_options.h"
#include "front_tracker/patches/patch_templates.h"
#include "front_tracker/tracking/found_pose.h"
#include "front_tracker/tracking/motion_model.h"

namespace rumi::front_tracker {

class PoseByPatches {
 public:
  // `max_motion`: limit for the sum over all images since the last one with corners; see KeyframeOptions.
  PoseByPatches(const TrackingOptions& options, double max_motion) : options_(options), max_motion_(max_motion) {}

  // Returns false if the next image must be searched for corners, whatever it shows.
  bool may_do(const MotionModel& motion, int64_t utime_us) const;
  FoundPose find(const FrontSubmap& submap, const MotionModel& motion, int64_t utime_us,
                 std::shared_ptr<const ImagePyramid> images, PatchTemplates* templates) const;
  // To be called for each frame from which tracking goes on.
  void note(const FoundPose& accepted);

 private:
  std::string look(const FrontSubmap& submap, const MotionModel& motion, FoundPose* pose,
                   PatchTemplates* templates) const;

  TrackingOptions options_;
  double max_motion_;
  int64_t last_corners_us_ = 0;      // time of the last image in which corners were detected
  double motion_since_corners_ = 0;  // sum of the images' motion since then, as a share of their width
};

}  // namespace rumi::front_tracker
