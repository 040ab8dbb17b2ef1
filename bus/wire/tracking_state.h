// SPDX-License-Identifier: BSD-3-Clause
// Converts a TrackingState to and from the field `state` of a track_t.
#pragma once

#include <cstdint>
#include <optional>

#include "lcmtypes/rumi/track_t.hpp"
#include "slam/map/tracking_state.h"

namespace rumi {

inline int8_t to_wire(TrackingState state) { return static_cast<int8_t>(state); }

// Returns nullopt for a number that is no state.
inline std::optional<TrackingState> state_from_wire(int8_t state) {
  if (state < track_t::NOT_INITIALIZED || state > track_t::LOST) return std::nullopt;
  return static_cast<TrackingState>(state);
}

}  // namespace rumi
