// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace rumi {

// As in track_t; kUnknown: the frame is known from a submap only, its RUMI_TRACK message was lost.
enum class TrackingState : int8_t { kUnknown = -1, kNotInitialized = 0, kTracking = 1, kRecentlyLost = 2, kLost = 3 };

// How many frames back front_tracker may give or withdraw a pose at most, and whoever follows it is ready for.
inline constexpr int kMostRetoldFrames = 120;

const char* to_string(TrackingState state);

}  // namespace rumi
