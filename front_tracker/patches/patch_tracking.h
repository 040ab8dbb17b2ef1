// SPDX-License-Identifier: BSD-3-Clause
// Short-term association by image alignment: if an image hardly differs from the last one, the landmarks are found
// again by the patches around them, at a fraction of the cost of detecting and describing corners.
#pragma once

#include "front_tracker/frame/front_submap.h"
#include "front_tracker/patches/patch_templates.h"

namespace rumi::front_tracker {

// Both functions look for landmarks of `last` at the pose of *frame, which has images. They replace its features by the
// ones that are found, and refine its pose.

// Looks for a few landmarks in coarse levels, starting from a predicted pose. Returns false if no pose is found.
bool find_pose_by_patches(const FrontSubmap& submap, const Frame& last, Frame* frame, PatchTemplates* templates);

// Looks for every landmark of `last`, in the pyramid level in which `last` observed it.
struct PatchTracking {
  int in_view = 0;  // landmarks that should be in view
  int inliers = 0;  // those that are found and agree with the pose
};
PatchTracking track_by_patches(const FrontSubmap& submap, const Frame& last, Frame* frame, PatchTemplates* templates);

}  // namespace rumi::front_tracker
