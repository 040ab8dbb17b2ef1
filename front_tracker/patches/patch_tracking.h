// SPDX-License-Identifier: BSD-3-Clause
// Short-term association by image alignment: where an image hardly differs from the last one, the last one's landmarks
// are found again by the patches around them, for a fraction of what it costs to look for corners and to describe them.
#pragma once

#include "front_tracker/frame/front_submap.h"
#include "front_tracker/patches/patch_templates.h"

namespace rumi::front_tracker {

// Both look for landmarks that `last` is matched to, where the pose of *frame puts them. The frame has images; its
// features become those that are found, its pose is refined.

// A few of them in coarse images: for a pose that is predicted. False where it cannot be told.
bool find_pose_by_patches(const FrontSubmap& submap, const Frame& last, Frame* frame, PatchTemplates* templates);

// All of them, each in the level where the last frame has it.
struct PatchTracking {
  int in_view = 0;  // landmarks that should be in view
  int inliers = 0;  // of them, found and in agreement with the pose
};
PatchTracking track_by_patches(const FrontSubmap& submap, const Frame& last, Frame* frame, PatchTemplates* templates);

}  // namespace rumi::front_tracker
