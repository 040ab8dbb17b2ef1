// SPDX-License-Identifier: BSD-3-Clause
// Thins the frames of a gap to a cap, by how far the picture moved and how sharp it is, not by their number alone. At
// 5 Hz every frame is precious, at 30 Hz most frames of a slow motion are redundant.
//
// - Up to the cap all frames are kept, because a frame that is left out here stays without a pose. From then on, a
// frame
//   that hardly moved since the last one kept is left out at once.
// - Beyond the cap, each new frame displaces one. Frames that are blurred compared with their neighbours go first, as
//   long as these stay near enough to be matched (three set points, kGapMotionPx). Then goes the frame whose neighbours
//   are nearest to each other. So the remaining frames are even in motion, not in time.
// - The first and the last frame stay, because they tie the gap to the tracked frames.
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
  double sharpness = 0;  // see ImageMeasure; infinity: not measured, taken for sharp
};

class GapThinner {
 public:
  explicit GapThinner(int max_frames) : max_frames_(max_frames), cap_(max_frames) {}

  // Adds the next frame, in order of time.
  void add(const GapFrame& frame);
  // Adds frames of any times, which are in order.
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
