// SPDX-License-Identifier: BSD-3-Clause
// Any recording -> what other programs read: an lcm log of CAMERA images for lcm-logplayer, or a bag of ROS, with the
// poses of a run.
#pragma once

#include <atomic>
#include <string>

#include "camera_driver/options.h"

namespace rumi::tool {

struct ExportOptions {
  std::string input;    // whatever camera_driver takes
  std::string file;     // must not exist; NAME.mcap and NAME.bag are bags, all else is an lcm log
  std::string channel;  // of the images; empty: kLcmChannel, or kImageTopic in a bag
  std::string poses;    // of a bag: a run's folder, or a file of poses; empty: none
  camera_driver::CameraOptions camera;
  const std::atomic<bool>* stop = nullptr;  // ends it where it becomes true: then nothing is written; may be null
};

inline constexpr const char* kLcmChannel = "CAMERA";
inline constexpr const char* kImageTopic = "/camera/image_raw";

// The times are those of capture; the calibration goes with every image. Tells what it does, and what is wrong, on
// stderr. Returns the exit code. A file that could not be completed is removed.
int run_export(const ExportOptions& options);

}  // namespace rumi::tool
