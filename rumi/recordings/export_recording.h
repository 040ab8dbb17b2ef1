// SPDX-License-Identifier: BSD-3-Clause
// Writes any recording for other programs: as an lcm log of CAMERA images for lcm-logplayer, or as a ROS bag with the
// poses of a run.
#pragma once

#include <atomic>
#include <string>

#include "camera_driver/options.h"

namespace rumi::tool {

struct ExportOptions {
  std::string input;    // whatever camera_driver takes
  std::string file;     // must not exist; NAME.mcap and NAME.bag are bags, all else is an lcm log
  std::string channel;  // channel or topic of the images; empty: kLcmChannel, or kImageTopic in a bag
  std::string poses;    // for a bag: a run's folder, or a file of poses; empty: none
  camera_driver::CameraOptions camera;
  const std::atomic<bool>* stop = nullptr;  // ends it, with nothing written, when it becomes true; may be null
};

inline constexpr const char* kLcmChannel = "CAMERA";
inline constexpr const char* kImageTopic = "/camera/image_raw";

// The times are those of capture; the calibration goes with every image. Progress and errors are printed on stderr.
// Returns the exit code. A file that could not be completed is removed.
int run_export(const ExportOptions& options);

}  // namespace rumi::tool
