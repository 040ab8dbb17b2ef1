// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "front_tracker/frame/frame.h"
#include "front_tracker/frame/tracking_options.h"

namespace rumi::front_tracker {

// Does the frame see enough landmarks whose distance is known (TrackingOptions::min_established)? Else nothing holds
// the scale of what follows.
bool carries_scale(const Submap& map, const Frame& frame, const TrackingOptions& options);

}  // namespace rumi::front_tracker
