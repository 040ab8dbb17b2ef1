// SPDX-License-Identifier: BSD-3-Clause
// Finds the order in which the frames of a recording are played, from their recorded times. Broken clocks are common,
// and so are recorders that do not write images in the order of their times.
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
  int part = 0;            // number of the part; a new one begins where the clock was set back
};

struct FrameOrder {
  std::vector<OrderedFrame> frames;
  std::vector<size_t> duplicates;   // left out: another frame has the same time
  std::vector<size_t> wrong_times;  // left out: the time is far from those of the frames around it
  bool is_sorted = false;           // frames were not stored in the order of their times
};

// Finds the order of the frames:
// - If all times rise, except for a few, those few are put where their time belongs; they are left out if that is far
//   from where they are stored.
// - A few frames at either end are left out if more than a minute, and more than ten times the length of all others,
//   lies between them and the others.
// - If times go back and rise again from there for more than a few frames, a new part begins. More than three parts
//   whose times do not overlap are sorted by time into one part.
// - If times are in disorder, all frames are sorted by time.
// An Error if most frames have the time of another one, or if the times come from two clocks in turn.
Result<FrameOrder> order_frames(const std::vector<int64_t>& utimes_us);

// Gives frames new times at this rate, in the order in which they are stored, from `first_us` on. Precondition: rate_hz
// > 0.
FrameOrder frames_at_rate(size_t count, double rate_hz, int64_t first_us);

}  // namespace rumi::camera_driver
