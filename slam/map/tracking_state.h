// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace rumi {

// The values are those of track_t. kUnknown: the frame is known from a submap only; its RUMI_TRACK message was lost.
enum class TrackingState : int8_t { kUnknown = -1, kNotInitialized = 0, kTracking = 1, kRecentlyLost = 2, kLost = 3 };

// front_tracker gives poses to earlier frames, or withdraws them, at most this many frames back. Who follows its
// messages keeps as many.
inline constexpr int kMostRetoldFrames = 120;

const char* to_string(TrackingState state);

}  // namespace rumi
