// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/tracking/pose_by_patches.h"

#include "front_tracker/frame/certainty.h"
#include "front_tracker/patches/patch_tracking.h"

namespace rumi::front_tracker {

// After an image with few corners, the next one is searched for corners too: the first of the images that blur or
// darken must become a keyframe, because the next ones are matched with its corners.
bool PoseByPatches::may_do(const MotionModel& motion, int64_t utime_us) const {
  const double since_corners_s = 1e-6 * static_cast<double>(utime_us - last_corners_us_);
  return motion.is_known() && since_corners_s < options_.corner_interval_s && motion.last().corners != Corners::kFew;
}

FoundPose PoseByPatches::find(const FrontSubmap& submap, const MotionModel& motion, int64_t utime_us,
                              std::shared_ptr<const ImagePyramid> images, PatchTemplates* templates) const {
  FoundPose pose;
  pose.frame.utime_us = utime_us;
  pose.frame.images = std::move(images);
  pose.frame.corners = Corners::kNone;
  pose.frame.cam_from_submap = motion.predict(utime_us);
  pose.frame.reference_keyframe = motion.last().reference_keyframe;
  pose.why_not = look(submap, motion, &pose, templates);
  return pose;
}

// Returns why no pose is found, or an empty string.
std::string PoseByPatches::look(const FrontSubmap& submap, const MotionModel& motion, FoundPose* pose,
                                PatchTemplates* templates) const {
  // The least share of the landmarks in view. Fewer are found when the image begins to blur or darken.
  constexpr double kLeastFound = 0.8;
  if (submap.images.empty()) return "no keyframe has an image";
  Frame* frame = &pose->frame;
  if (!find_pose_by_patches(submap, motion.last(), frame, templates)) return "too few patches are found";
  const double image_motion = motion.image_motion(submap.map, *frame);
  if (image_motion > options_.patch_motion) return "the image moves fast";
  if (motion_since_corners_ + image_motion > max_motion_) return "a keyframe may be due";
  const PatchTracking tracked = track_by_patches(submap, motion.last(), frame, templates);
  if (tracked.inliers < kLeastFound * tracked.in_view) return "too few of the landmarks in view are found";
  frame->certainty = certainty_of(submap.map, submap.octave_scales, *frame);
  if (frame->certainty.image_px > options_.uncertain_px) return "the pose is uncertain";
  pose->motion = image_motion;
  return {};
}

void PoseByPatches::note(const FoundPose& accepted) {
  if (accepted.frame.corners == Corners::kNone) {
    motion_since_corners_ += accepted.motion.value_or(0);
    return;
  }
  last_corners_us_ = accepted.frame.utime_us;
  motion_since_corners_ = 0;
}

}  // namespace rumi::front_tracker
