// SPDX-License-Identifier: BSD-3-Clause
#include "camera_driver/source/frame_selector.h"

#include "base/text/time_units.h"

namespace rumi::camera_driver {

FrameSelector::FrameSelector(const CameraOptions& options)
    : start_us_(to_us(options.start_s)), duration_us_(to_us(options.duration_s)), every_(options.every) {}

FrameSelector::Verdict FrameSelector::judge(int64_t utime_us) {
  if (last_us_ && utime_us == *last_us_) return Verdict::kDuplicate;
  if (last_us_ && utime_us < *last_us_) return Verdict::kOutOfOrder;
  if (!first_us_) first_us_ = utime_us;
  last_us_ = utime_us;
  const int64_t since_start_us = utime_us - *first_us_ - start_us_;
  if (since_start_us < 0) return Verdict::kPass;
  if (duration_us_ > 0 && since_start_us >= duration_us_) return Verdict::kEnd;
  return wanted_++ % every_ == 0 ? Verdict::kTake : Verdict::kPass;
}

void FrameSelector::rewind() {
  first_us_.reset();
  last_us_.reset();
  wanted_ = 0;
}

}  // namespace rumi::camera_driver
