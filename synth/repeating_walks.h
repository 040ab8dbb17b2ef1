// SPDX-License-Identifier: BSD-3-Clause
// Walks in scenes that repeat exactly. On the way from one copy to the next nothing is seen, so that tracking is lost,
// and what is seen next looks like what was seen before.
#pragma once

#include <cstdint>

#include "synth/next_room_walk.h"

namespace rumi::synth {

inline constexpr double kMinRepeatingSeconds = 16, kMaxRepeatingSeconds = 300;

// The walk into the next room. The second room is the first one, turned by 180 degrees about the doorway.
Walk walk_to_twin_room(double seconds, uint64_t seed);
// Three storeys, with a walk about in each, and a lift in which nothing is seen.
Walk walk_up_storeys(double seconds, uint64_t seed);
// A corridor with a door on both sides every kDoorEvery_m; a part of it is dark.
inline constexpr double kDoorEvery_m = 3;
Walk walk_past_doors(double seconds, uint64_t seed);
// Two rounds or more in the middle of a square with four equal sides, with two moments at which nothing is seen.
Walk walk_round_square(double seconds, uint64_t seed);

}  // namespace rumi::synth
