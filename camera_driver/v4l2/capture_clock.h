// SPDX-License-Identifier: BSD-3-Clause
// Kernel time stamps -> utime of capture on the system clock.
#pragma once

#include <cstdint>
#include <optional>

#include "camera_driver/v4l2/video_system.h"

namespace rumi::camera_driver {

// The times that are known when a frame is dequeued.
struct FrameStamps {
  int64_t stamp_us = 0;           // the driver's stamp, CLOCK_MONOTONIC
  bool monotonic = true;          // the driver does not say that it is of another clock
  bool start_of_exposure = true;  // false: the stamp is of the last pixel's arrival
  int64_t exposure_us = 0;        // 0: not known
  VideoSystem::Clocks now;        // at the dequeuing
};

class CaptureClock {
 public:
  // The middle of the exposure where its length is known, else the driver's stamp as it is. A stamp that cannot be
  // right (another clock, later than now, more than 10 s ago) is replaced by the time of dequeuing and counted. The
  // result may not rise: that is for the caller to see.
  //
  // The system clock is measured against the monotonic one once, and followed from there by at most 5 ms in a second:
  // a correction of the clock must not look like motion. It is followed at once when it was set forward by more than
  // a second; when it was set back, times of capture go on as they were.
  int64_t utime_us(const FrameStamps& stamps);

  int64_t replaced() const { return replaced_; }
  // The step by which the system clock was set since the last call, which is not followed slowly.
  std::optional<int64_t> take_step_us();

 private:
  void follow(const VideoSystem::Clocks& now);
  std::optional<int64_t> offset_us_;  // system minus monotonic
  int64_t followed_at_us_ = 0;        // monotonic
  int64_t measured_us_ = 0;           // latest offset
  int64_t replaced_ = 0;
  std::optional<int64_t> step_us_;
};

}  // namespace rumi::camera_driver
