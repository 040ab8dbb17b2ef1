// SPDX-License-Identifier: BSD-3-Clause
// Tracking may slip before a loss. Then the same things lie at two places of the submap: where they were seen long ago,
// and where the last frames put them.
#pragma once

#include <cstdint>
#include <vector>

#include "front_tracker/frame/front_submap.h"
#include "front_tracker/relocalization/relocalizer.h"
#include "front_tracker/tracking/support_history.h"

namespace rumi::front_tracker {

// Tests whether the newest keyframes of the history contradict the pose at which `found` was found again: then tracking
// has slipped. Takes the frames since the slip out of the submap and of the history, and returns their times,
// ascending. Returns none if there was no slip, or if these frames cannot be cut off: `found` refers to one of their
// keyframes, or no older keyframe would be left.
std::vector<int64_t> withdraw_slip(const Relocalizer& relocalizer, const Frame& found, SupportHistory* history,
                                   FrontSubmap* submap);

}  // namespace rumi::front_tracker
