// SPDX-License-Identifier: BSD-3-Clause
#include "bus/wire/tracking_state.h"

#include <gtest/gtest.h>

namespace rumi {
namespace {

TEST(TrackingState, SurvivesTheWireAndOtherNumbersAreNone) {
  for (const TrackingState state :
       {TrackingState::kNotInitialized, TrackingState::kTracking, TrackingState::kRecentlyLost, TrackingState::kLost})
    EXPECT_EQ(state_from_wire(to_wire(state)), state);
  EXPECT_EQ(to_wire(TrackingState::kLost), track_t::LOST);
  for (const int number : {-128, -1, int{track_t::LOST} + 1, 127})
    EXPECT_FALSE(state_from_wire(static_cast<int8_t>(number))) << number;
}

}  // namespace
}  // namespace rumi
