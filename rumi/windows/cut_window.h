// SPDX-License-Identifier: BSD-3-Clause
// A window made of chosen frames of a recording, as if tracking had been lost there: what a back submap of these frames
// would be, whatever front_tracker thinks of them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "ruminator/window/window_job.h"

namespace rumi::camera_driver {
class ImageSource;
}

namespace rumi::tool {

// Frames by number; the first of a recording is 0.
struct FrameRange {
  int64_t first = 0, last = -1;  // both belong to it
  int64_t stride = 1;            // from one to the next

  bool contains(int64_t frame) const { return frame >= first && frame <= last && (frame - first) % stride == 0; }
  std::string to_string() const;
};

// "FIRST..LAST" or "FIRST..LAST:STRIDE". Returns what is wrong, or an empty string.
std::string parse_frame_range(const std::string& text, FrameRange* range);

struct WindowCut {
  std::optional<FrameRange> approach;   // S1
  FrameRange gap;                       // S2
  std::optional<FrameRange> departure;  // S3

  // What is wrong, or an empty string: they follow one another.
  std::string check() const;
};

struct CutWindow {
  ruminator::WindowJob job;
  std::string error;  // empty, or what is wrong
  bool ok() const { return error.empty(); }
};

// The samples have no poses of front_tracker and are no keyframes, so what is built of it is not compared with any.
CutWindow cut_window(camera_driver::ImageSource& source, const WindowCut& cut);

}  // namespace rumi::tool
