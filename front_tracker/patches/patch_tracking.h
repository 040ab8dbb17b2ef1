// SPDX-License-Identifier: BSD-3-Clause
// Short-term association by image alignment: if an image differs little from the last one, the landmarks are found
// again by the patches around them. That costs a fraction of detecting and describing corners.
#pragma once

#include "front_tracker/frame/front_submap.h"
#include "front_tracker/patches/patch_templates.h"

namespace rumi::front_tracker {

// Both functions look for landmarks of `last` at the pose of *frame, which has images. They replace the frame's
// features by those that are found, and refine its pose.

// Looks for a few landmarks in coarse levels, starting from a predicted pose. Returns false if no pose is found.
bool find_pose_by_patches(const FrontSubmap& submap, const Frame& last, Frame* frame, PatchTemplates* templates);

// Looks for every landmark of `last`, in the pyramid level in which `last` observed it.
struct PatchTracking {
  int in_view = 0;  // landmarks that should be in view
  int inliers = 0;  // those of them that are found and agree with the pose
};
PatchTracking track_by_patches(const FrontSubmap& submap, const Frame& last, Frame* frame, PatchTemplates* templates);

}  // namespace rumi::front_tracker
