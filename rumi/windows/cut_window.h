// SPDX-License-Identifier: BSD-3-Clause
// Makes a window of chosen frames of a recording, as if tracking had been lost there. It shows which back submap these
// frames would give, whether or not front_tracker is lost there.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "base/result.h"
#include "ruminator/window/window_job.h"

namespace rumi::camera_driver {
class ImageSource;
}

namespace rumi::tool {

// Numbers of frames; the first of a recording is 0.
struct FrameRange {
  int64_t first = 0, last = -1;  // both included
  int64_t stride = 1;            // frames from one sample to the next

  bool contains(int64_t frame) const { return frame >= first && frame <= last && (frame - first) % stride == 0; }
  std::string to_string() const;
};

// Parses "FIRST..LAST" or "FIRST..LAST:STRIDE". An Error if the text is something else.
Result<FrameRange> parse_frame_range(const std::string& text);

struct WindowCut {
  std::optional<FrameRange> approach;   // S1 in the paper
  FrameRange gap;                       // S2 in the paper
  std::optional<FrameRange> departure;  // S3 in the paper

  // An Error if the parts overlap or are in another order.
  Result<> check() const;
};

// The samples have no poses of front_tracker and are not keyframes, so a back submap of the window is not compared with
// any front submap. An Error if `cut` is wrong, or if the recording ends before the window does.
Result<ruminator::WindowJob> cut_window(camera_driver::ImageSource& source, const WindowCut& cut);

}  // namespace rumi::tool
