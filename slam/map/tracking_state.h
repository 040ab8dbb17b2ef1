// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace rumi {

// The values are those of track_t. kUnknown: its RUMI_TRACK message was lost, and the frame is known only from a
// submap.
enum class TrackingState : int8_t { kUnknown = -1, kNotInitialized = 0, kTracking = 1, kRecentlyLost = 2, kLost = 3 };

// The number of latest frames to which front_tracker may give poses afterwards, or from which it may withdraw them.
// Receivers of its messages keep as many frames.
inline constexpr int kMostRetoldFrames = 120;

const char* to_string(TrackingState state);

}  // namespace rumi
