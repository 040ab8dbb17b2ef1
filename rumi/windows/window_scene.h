// SPDX-License-Identifier: BSD-3-Clause
// A rumination window as an lcm log records it: the frames around a loss, whether each has a pose, and which of them
// were sampled.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "base/result.h"
#include "lcmtypes/rumi/window_t.hpp"

namespace rumi::tool {

enum class SampledAs { kNot, kApproach, kGap, kDeparture };

struct SceneFrame {
  int64_t utime_us = 0;
  int8_t state = 0;       // as in the track_t of the frame
  bool has_pose = false;  // from the beginning, or added afterwards
  bool is_keyframe = false;
  SampledAs sampled_as = SampledAs::kNot;
  cv::Mat image;  // BGR, reduced; empty if the log has no image of the frame
};

struct WindowScene {
  window_t window;                 // as it was announced last
  int64_t begin_us = 0;            // time of the log's first image; times in the picture count from it
  std::vector<SceneFrame> frames;  // the window's frames, and some before and after, in order of time
};

// Reads a window from RUMI_WINDOW, RUMI_TRACK and CAMERA of a log. window_id 0: the first window with a gap between two
// submaps, or else the first. If several sessions have a window of that number, the last one is taken. An Error if the
// log has no such window, or if it is too long to be drawn.
Result<WindowScene> read_window_scene(const std::string& log_file, int window_id);

}  // namespace rumi::tool
