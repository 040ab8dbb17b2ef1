// SPDX-License-Identifier: BSD-3-Clause
// Converts kernel time stamps to the utime of capture on the system clock.
#pragma once

#include <cstdint>
#include <optional>

#include "camera_driver/v4l2/video_system.h"

namespace rumi::camera_driver {

// The times that are known when a frame is dequeued.
struct FrameStamps {
  int64_t stamp_us = 0;           // the driver's stamp, CLOCK_MONOTONIC
  bool monotonic = true;          // false: the driver says that the stamp is of another clock
  bool start_of_exposure = true;  // false: the stamp is of the last pixel's arrival
  int64_t exposure_us = 0;        // exposure time; 0: not known
  VideoSystem::Clocks now;        // clocks when the frame was dequeued
};

class CaptureClock {
 public:
  // Returns the middle of the exposure if its length is known, else the driver's stamp as it is. A stamp that cannot be
  // right (another clock, more than 1 s later than now, more than 10 s ago) is replaced by the time of dequeuing and
  // counted. The results need not rise: the caller has to check that.
  //
  // The offset of the system clock from the monotonic one is measured at the first frame. Later it is followed by at
  // most 5 ms in a second: a correction of the clock must not look like motion. If the system clock was set forward by
  // more than a second, the offset follows at once; if it was set back by more than that, the offset stays, so that
  // times go on as before.
  int64_t utime_us(const FrameStamps& stamps);

  int64_t replaced() const { return replaced_; }
  // Returns the last step of more than a second by which the system clock was set since the last call; nullopt if it
  // was not set.
  std::optional<int64_t> take_step_us();

 private:
  void follow(const VideoSystem::Clocks& now);
  std::optional<int64_t> offset_us_;  // system clock minus monotonic clock, as applied to stamps: follows measured_us_
                                      // slowly; nullopt before the first frame
  int64_t followed_at_us_ = 0;        // monotonic time when offset_us_ was last adapted
  int64_t measured_us_ = 0;           // latest measured offset
  int64_t replaced_ = 0;
  std::optional<int64_t> step_us_;
};

}  // namespace rumi::camera_driver
