// SPDX-License-Identifier: BSD-3-Clause
// Landmarks that are in view and that no keypoint is matched to: the corner detector found other corners this time
// (three in five in a fast turn). Where the pose is known to a few pixels they are looked for by what they look like,
// and get keypoints of their own.
#pragma once

#include <vector>

#include "front_tracker/frame/front_submap.h"
#include "front_tracker/patches/patch_templates.h"

namespace rumi::front_tracker {

// Adds keypoints to the frame, at its present pose, for those of the landmarks `visible` that it is not matched to,
// those that most keyframes have seen first, until it has `wanted` matches. Their descriptors are those of the
// landmarks' latest observations. Returns the number added; none where no images are kept.
int search_by_patch(const FrontSubmap& submap, const std::vector<int>& visible, int wanted, Frame* frame,
                    PatchTemplates* templates);

}  // namespace rumi::front_tracker
