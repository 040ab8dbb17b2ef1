// SPDX-License-Identifier: BSD-3-Clause
#include "slam/map/tracking_state.h"

namespace rumi {

const char* to_string(TrackingState state) {
  switch (state) {
    case TrackingState::kNotInitialized:
      return "NOT_INITIALIZED";
    case TrackingState::kTracking:
      return "TRACKING";
    case TrackingState::kRecentlyLost:
      return "RECENTLY_LOST";
    case TrackingState::kLost:
      return "LOST";
    case TrackingState::kUnknown:
      break;
  }
  return "UNKNOWN";
}

}  // namespace rumi
