// SPDX-License-Identifier: BSD-3-Clause
// Begins a submap: the initializer's structure becomes its first keyframes, landmarks and frames.
#pragma once

#include <vector>

#include "front_tracker/frame/front_submap.h"
#include "front_tracker/initialization/initial_structure.h"
#include "front_tracker/tracking/past_poses.h"
#include "slam/features/orb_extractor.h"

namespace rumi::front_tracker {

// `submap` is empty. Returns the frames that have a pose in it, in order of time; the last one is the newest image.
std::vector<Frame> add_first_map(InitialMap initial, const OrbExtractor& extractor, const PastPoses& past,
                                 FrontSubmap* submap);

}  // namespace rumi::front_tracker
