// SPDX-License-Identifier: BSD-3-Clause
// RUMI_MASK: what of a camera's images never moves.
#pragma once

#include <cstdint>

#include "bus/transport/bus.h"
#include "front_tracker/tracking/tracker.h"

namespace rumi::front_tracker {

class MaskPublisher {
 public:
  explicit MaskPublisher(Bus& bus) : bus_(bus) {}
  // Whenever the mask has changed, and again once a second while there is one; what is new is said in the log.
  void publish(const Tracker& tracker, int64_t utime_us, int64_t now_us);

 private:
  void tell(double left_out);

  Bus& bus_;
  int64_t session_ = 0;
  cv::Mat published_;  // pixels
  int64_t published_us_ = INT64_MIN;
  double told_ = 0;  // share that was said last
};

}  // namespace rumi::front_tracker
