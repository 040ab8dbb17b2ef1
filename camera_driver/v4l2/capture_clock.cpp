// SPDX-License-Identifier: BSD-3-Clause
#include "camera_driver/v4l2/capture_clock.h"

#include <algorithm>
#include <cstdlib>

namespace rumi::camera_driver {
namespace {

constexpr int64_t kOldestUs = 10'000'000;  // greatest age of a stamp when its frame is dequeued
constexpr int64_t kNewestUs = -1'000'000;  // least age: drivers may stamp when the last pixel is due, which is ahead
constexpr int64_t kStepUs = 1'000'000;     // a larger change of the offset is no drift: the clock was set
constexpr int64_t kSlewDivisor = 200;      // 5 ms per second

}  // namespace

void CaptureClock::follow(const VideoSystem::Clocks& now) {
  const int64_t measured_us = now.system_us - now.monotonic_us;
  if (!offset_us_) {
    offset_us_ = measured_us_ = measured_us;
    followed_at_us_ = now.monotonic_us;
    return;
  }
  if (std::abs(measured_us - measured_us_) > kStepUs) step_us_ = measured_us - measured_us_;
  measured_us_ = measured_us;
  const int64_t behind_us = measured_us - *offset_us_;
  const int64_t most_us = (now.monotonic_us - followed_at_us_) / kSlewDivisor;
  if (behind_us > kStepUs) {
    offset_us_ = measured_us;
  } else if (behind_us >= -kStepUs) {
    if (most_us == 0) return;  // followed_at_us_ stays, so that many short steps add up
    *offset_us_ += std::clamp(behind_us, -most_us, most_us);
  }
  followed_at_us_ = now.monotonic_us;
}

int64_t CaptureClock::utime_us(const FrameStamps& stamps) {
  follow(stamps.now);
  const int64_t age_us = stamps.now.monotonic_us - stamps.stamp_us;
  const bool right = stamps.monotonic && age_us >= kNewestUs && age_us <= kOldestUs;
  if (!right) ++replaced_;
  const int64_t to_middle_us = !right ? 0 : stamps.start_of_exposure ? stamps.exposure_us / 2 : -stamps.exposure_us / 2;
  return (right ? stamps.stamp_us : stamps.now.monotonic_us) + to_middle_us + *offset_us_;
}

std::optional<int64_t> CaptureClock::take_step_us() {
  const std::optional<int64_t> step = step_us_;
  step_us_.reset();
  return step;
}

}  // namespace rumi::camera_driver
