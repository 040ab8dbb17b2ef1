// SPDX-License-Identifier: BSD-3-Clause
#include "camera_driver/v4l2/capture_clock.h"

#include <gtest/gtest.h>

namespace rumi::camera_driver {
namespace {

constexpr int64_t kOffsetUs = 1'700'000'000'000'000, kSecondUs = 1'000'000;

// Returns the stamps of a frame that has the time `t` of the monotonic clock and is dequeued 10 ms later, while the
// system clock is off by `shift_us`.
FrameStamps frame(int64_t t, int64_t shift_us = 0) {
  FrameStamps stamps;
  stamps.stamp_us = t;
  stamps.now = {t + 10'000, t + 10'000 + kOffsetUs + shift_us};
  return stamps;
}

TEST(CaptureClock, MiddleOfTheExposureByWhatTheStampMeans) {
  CaptureClock clock;
  FrameStamps stamps = frame(5 * kSecondUs);
  EXPECT_EQ(clock.utime_us(stamps), 5 * kSecondUs + kOffsetUs);
  stamps.exposure_us = 8000;
  EXPECT_EQ(clock.utime_us(stamps), 5 * kSecondUs + kOffsetUs + 4000);
  stamps.start_of_exposure = false;
  EXPECT_EQ(clock.utime_us(stamps), 5 * kSecondUs + kOffsetUs - 4000);
  EXPECT_EQ(clock.replaced(), 0);
}

TEST(CaptureClock, FollowsASmallCorrectionSlowly) {
  for (const int64_t shift_us : {300'000, -300'000}) {
    CaptureClock clock;
    int64_t last = clock.utime_us(frame(0)), t = 0;
    for (; t < 100 * kSecondUs;) {
      t += 33'333;
      const int64_t utime = clock.utime_us(frame(t, shift_us));
      EXPECT_NEAR(static_cast<double>(utime - last), 33'333, 33'333 / 200 + 1);
      last = utime;
    }
    EXPECT_NEAR(static_cast<double>(last - (t + kOffsetUs + shift_us)), 0, 10);
    EXPECT_FALSE(clock.take_step_us().has_value());
  }
}

TEST(CaptureClock, JumpsForwardWithTheSystemClockButNeverBack) {
  CaptureClock clock;
  clock.utime_us(frame(kSecondUs));
  EXPECT_EQ(clock.utime_us(frame(2 * kSecondUs, 60 * kSecondUs)), 62 * kSecondUs + kOffsetUs);
  EXPECT_EQ(clock.take_step_us(), 60 * kSecondUs);
  EXPECT_EQ(clock.take_step_us(), std::nullopt);
  EXPECT_EQ(clock.utime_us(frame(3 * kSecondUs, 0)), 63 * kSecondUs + kOffsetUs);
  EXPECT_EQ(clock.take_step_us(), -60 * kSecondUs);
  EXPECT_EQ(clock.utime_us(frame(4 * kSecondUs, 0)), 64 * kSecondUs + kOffsetUs);
}

TEST(CaptureClock, StampsThatCannotBeAreReplaced) {
  CaptureClock clock;
  const int64_t t = 100 * kSecondUs;
  for (const int64_t wrong : {t + 2 * kSecondUs, t - 20 * kSecondUs, int64_t{0}, INT64_MIN / 4}) {
    FrameStamps stamps = frame(t);
    stamps.stamp_us = wrong;
    stamps.exposure_us = 1000;
    EXPECT_EQ(clock.utime_us(stamps), t + 10'000 + kOffsetUs) << wrong;
  }
  EXPECT_EQ(clock.replaced(), 4);
}

}  // namespace
}  // namespace rumi::camera_driver
