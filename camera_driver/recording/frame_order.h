// SPDX-License-Identifier: BSD-3-Clause
// The order in which the frames of a recording are played, from their times as recorded: broken clocks and recorders
// that write in another order than that of the images are common.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "base/result.h"

namespace rumi::camera_driver {

struct OrderedFrame {
  size_t frame = 0;        // number in the recording, from 0
  int64_t utime_us = 0;    // rises strictly within a part
  int64_t elapsed_us = 0;  // since the first frame, the parts one after the other; rises strictly
  int part = 0;            // another one begins where the clock was set back
};

struct FrameOrder {
  std::vector<OrderedFrame> frames;
  std::vector<size_t> duplicates;   // left out: another frame has the same time
  std::vector<size_t> wrong_times;  // left out: the time is far from those of the frames around it
  bool is_sorted = false;           // frames were not stored in the order of their times
};

// - Times that rise, but for a few: those are put where their time is, or left out if it is far from there.
// - A few at an end that are more than a minute, and ten times the length of all else, away from it are left out, too.
// - Times that go back and rise again from there, for more than a few frames: a new part. More than three
//   parts whose times do not overlap are put into the order of their times, as one.
// - Times in disorder: sorted.
// - Most frames have the time of another one, or of another clock than the one before: an error.
Result<FrameOrder> order_frames(const std::vector<int64_t>& utimes_us);

// Gives frames new times at this rate, in the order in which they are stored, from `first_us` on. Precondition: rate_hz
// > 0.
FrameOrder frames_at_rate(size_t count, double rate_hz, int64_t first_us);

}  // namespace rumi::camera_driver
