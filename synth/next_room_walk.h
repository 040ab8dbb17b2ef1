// SPDX-License-Identifier: BSD-3-Clause
// A walk on which tracking is lost. The camera goes about in one room, passes the doorway in a fast turn, out of focus
// and in little more than half the light, and goes about in the next room. Neither room is ever seen from the other
// one. So no place is seen twice, and only the images of the turn tell how the two rooms lie to each other.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "synth/camera_path.h"
#include "synth/options.h"
#include "synth/room.h"

namespace rumi::synth {

// A camera's path, the doorway that it passes, what repeats, and the hard passages on its way.
struct Walk {
  CameraPath path;
  std::optional<Doorway> doorway = {};
  std::optional<Repeats> repeats = {};
  std::vector<HardPassage> hard = {};  // at_s counts from the beginning of the path
};

inline constexpr double kMinNextRoomSeconds = 14, kMaxNextRoomSeconds = 60;

// The doorway is at the map's origin, in a wall along y. z is up.
Walk walk_to_next_room(double seconds, uint64_t seed);

}  // namespace rumi::synth
