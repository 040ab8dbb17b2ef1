// SPDX-License-Identifier: BSD-3-Clause
// Publishes RUMI_MASK: the parts of a camera's images that never move.
#pragma once

#include <cstdint>

#include "bus/transport/bus.h"
#include "front_tracker/tracking/tracker.h"

namespace rumi::front_tracker {

class MaskPublisher {
 public:
  explicit MaskPublisher(Bus& bus) : bus_(bus) {}
  // Publishes a mask that has changed, and repeats it once a second. Logs large changes.
  void publish(const Tracker& tracker, int64_t utime_us, int64_t now_us);

 private:
  void tell(double left_out);

  Bus& bus_;
  int64_t session_ = 0;
  cv::Mat published_;  // pixels of the mask that was published last
  int64_t published_us_ = INT64_MIN;
  double told_ = 0;  // share that is left out, as the log said last
};

}  // namespace rumi::front_tracker
