// SPDX-License-Identifier: BSD-3-Clause
// Looks for landmarks that should be in view but have no match, because the detector found other corners this time
// (three in five in a fast turn). If the pose is known to a few pixels, they are found by the patches around them and
// get new keypoints.
#pragma once

#include <vector>

#include "front_tracker/frame/front_submap.h"
#include "front_tracker/patches/patch_templates.h"

namespace rumi::front_tracker {

// Adds keypoints to the frame, at its present pose, for unmatched landmarks of `visible`, until it has `wanted`
// matches. Landmarks with the most observations come first. A keypoint gets the descriptor of the landmark's latest
// observation. Returns the number of added keypoints; 0 if no images are kept.
int search_by_patch(const FrontSubmap& submap, const std::vector<int>& visible, int wanted, Frame* frame,
                    PatchTemplates* templates);

}  // namespace rumi::front_tracker
