// SPDX-License-Identifier: BSD-3-Clause
// Limits the frames of a gap to a cap. It chooses them by the motion of the picture and its sharpness, not by time: at
// 5 Hz every frame is precious, while at 30 Hz most frames of a slow motion are redundant.
//
// - Up to the cap all frames are kept, because a frame left out here gets no pose. Once the cap is reached, a frame
//   that hardly moved since the last one kept is left out at once.
// - Beyond the cap, each new frame displaces one. Frames that are blurred compared with their neighbours go first, if
//   these stay near enough to each other to be matched (within three set points, kGapMotionPx). Otherwise the frame
//   goes whose neighbours are nearest to each other. So the remaining frames are spread evenly in motion, not in time.
// - The first and the last frame stay, because they connect the gap with the tracked frames.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "ruminator/window/rumination_window.h"
#include "ruminator/window/window_options.h"

namespace rumi::ruminator {

struct GapFrame {
  Sample sample;
  double path_px = 0;    // motion of the picture since the window opened, px; each unknown step counts as one set point
  double sharpness = 0;  // see ImageMeasure; infinity: not measured, counts as sharp
};

class GapThinner {
 public:
  explicit GapThinner(int max_frames) : max_frames_(max_frames), cap_(max_frames) {}

  // Adds the next frame in order of time.
  void add(const GapFrame& frame);
  // Adds frames at any times; they must be in order among themselves.
  void merge(const std::vector<GapFrame>& frames);
  // Removes the frame and returns it; nullopt if it is not there.
  std::optional<GapFrame> take(int64_t utime_us);
  void rename(int32_t from, int32_t to);  // as StrideSampler::rename()
  // Halves the number of frames and the cap. Returns false if only the first and the last frame are left.
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
