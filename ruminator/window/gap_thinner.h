// SPDX-License-Identifier: BSD-3-Clause
// The gap's frames, at most so many: by how far the picture moved and how sharp it is, not by their number alone. At
// 5 Hz every frame is precious, at 30 Hz most of a slow motion is redundant.
//
// - Up to the cap all are kept: what is left out here stays without a pose. From then on a frame that hardly moved
//   since the last one kept is left out at once.
// - Beyond the cap one frame goes for each that comes. First those that are blurred beside their neighbours, as long as
//   these stay near enough to be matched (three set points, kGapMotionPx); then the one whose neighbours are
//   nearest to each other. So what remains is even in motion, not in time.
// - The first and the last stay: they tie the gap to what was tracked.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "ruminator/window/rumination_window.h"
#include "ruminator/window/window_options.h"

namespace rumi::ruminator {

struct GapFrame {
  Sample sample;
  double path_px = 0;    // how far the picture has moved since the window opened; unknown steps count as one set point
  double sharpness = 0;  // see ImageMeasure; infinity: not measured, and not blurred for all that is known
};

class GapThinner {
 public:
  explicit GapThinner(int max_frames) : max_frames_(max_frames), cap_(max_frames) {}

  // The next frame, in order of time.
  void add(const GapFrame& frame);
  // Frames of any times, in order.
  void merge(const std::vector<GapFrame>& frames);
  // Removes the frame and returns it.
  std::optional<GapFrame> take(int64_t utime_us);
  // Halves the frames and the cap; false if there is nothing to halve.
  bool halve();

  const std::vector<GapFrame>& frames() const { return frames_; }
  std::vector<Sample> samples() const;

 private:
  void thin_to(size_t count);
  size_t most_dispensable() const;
  bool is_blurred(size_t index) const;

  int max_frames_;
  int cap_;
  std::vector<GapFrame> frames_;
};

}  // namespace rumi::ruminator
