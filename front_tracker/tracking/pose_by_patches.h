// SPDX-License-Identifier: BSD-3-Clause
// A frame's pose without looking for corners in it: in slow motion, soon after an image with corners, the last frame's
// landmarks are found again by the patches around them.
//
// Such a frame becomes no keyframe. So corners are due, too, once the images without have moved by as much as makes a
// keyframe due.
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
  // `max_motion`: of the images since the last one with corners, in all, see KeyframeOptions.
  PoseByPatches(const TrackingOptions& options, double max_motion) : options_(options), max_motion_(max_motion) {}

  // False: the next image needs corners, whatever it shows.
  bool may_do(const MotionModel& motion, int64_t utime_us) const;
  FoundPose find(const FrontSubmap& submap, const MotionModel& motion, int64_t utime_us,
                 std::shared_ptr<const ImagePyramid> images, PatchTemplates* templates) const;
  // Of each frame that tracking goes on from.
  void note(const FoundPose& accepted);

 private:
  std::string look(const FrontSubmap& submap, const MotionModel& motion, FoundPose* pose,
                   PatchTemplates* templates) const;

  TrackingOptions options_;
  double max_motion_;
  int64_t last_corners_us_ = 0;      // of the last image that corners were looked for in
  double motion_since_corners_ = 0;  // of the images since then, of their width
};

}  // namespace rumi::front_tracker
