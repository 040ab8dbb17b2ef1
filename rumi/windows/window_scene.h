// SPDX-License-Identifier: BSD-3-Clause
// A rumination window as an lcm log tells of it: which frames there were around a loss, what became of each, and which
// were sampled.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "lcmtypes/rumi/window_t.hpp"

namespace rumi::tool {

enum class SampledAs { kNot, kApproach, kGap, kDeparture };

struct SceneFrame {
  int64_t utime_us = 0;
  int8_t state = 0;       // as in track_t, when the frame came
  bool has_pose = false;  // then or afterwards
  bool is_keyframe = false;
  SampledAs sampled_as = SampledAs::kNot;
  cv::Mat image;  // BGR, reduced; empty if the log does not have it
};

struct WindowScene {
  window_t window;                 // as last announced
  int64_t begin_us = 0;            // of the log's first image: times are counted from it
  std::vector<SceneFrame> frames;  // of the window and some before and after, in order of time
};

struct WindowSceneResult {
  WindowScene scene;
  std::string error;
  bool ok() const { return error.empty(); }
};

// Reads RUMI_WINDOW, RUMI_TRACK and CAMERA of a log. window_id 0: the first window with a gap between two submaps, or
// else the first. Where several sessions have a window of that number, the last of them counts.
WindowSceneResult read_window_scene(const std::string& log_file, int window_id);

}  // namespace rumi::tool
