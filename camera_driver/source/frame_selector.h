// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "camera_driver/source/camera_options.h"

namespace rumi::camera_driver {

// Selects frames of a recording by their times alone.
class FrameSelector {
 public:
  enum class Verdict { kTake, kPass, kEnd, kDuplicate, kOutOfOrder };
  explicit FrameSelector(const CameraOptions& options);
  Verdict judge(int64_t utime_us);
  void rewind();

 private:
  int64_t start_us_, duration_us_;
  int every_;
  std::optional<int64_t> first_us_, last_us_;  // recorded times in this pass
  int64_t wanted_ = 0;                         // frames so far that lie within start and duration
};

}  // namespace rumi::camera_driver
