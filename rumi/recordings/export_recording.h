// SPDX-License-Identifier: BSD-3-Clause
// Writes any recording for other programs: as an lcm log of CAMERA images for lcm-logplayer, or as a ROS bag with the
// poses of a run.
#pragma once

#include <atomic>
#include <string>

#include "camera_driver/options.h"

namespace rumi::tool {

struct ExportOptions {
  std::string input;    // any recording that camera_driver can read
  std::string file;     // must not exist; NAME.mcap and NAME.bag are bags, any other name is an lcm log
  std::string channel;  // channel or topic of the images; empty: kLcmChannel in a log, kImageTopic in a bag
  std::string poses;    // only for a bag: a run's folder, or a file of poses; empty: no poses
  camera_driver::CameraOptions camera;
  const std::atomic<bool>* stop = nullptr;  // when it becomes true, the export ends and nothing is written; may be null
};

inline constexpr const char* kLcmChannel = "CAMERA";
inline constexpr const char* kImageTopic = "/camera/image_raw";

// Exports the images with their times of capture and the calibration. Prints progress and errors on stderr. Returns the
// exit code. A file that could not be completed is removed.
int run_export(const ExportOptions& options);

}  // namespace rumi::tool
