// SPDX-License-Identifier: BSD-3-Clause
// Any recording -> lcm log of CAMERA images, for lcm-logplayer and everyone who reads lcm logs.
#pragma once

#include <string>

#include "camera_driver/options.h"

namespace rumi::tool {

struct ExportOptions {
  std::string input;  // whatever camera_driver takes
  std::string log;    // must not exist
  std::string channel = "CAMERA";
  camera_driver::CameraOptions camera;
};

// Event time = capture time; the calibration is in every image's metadata. Tells what it does, and what is wrong, on
// stderr. Returns the exit code. A log that could not be completed is removed.
int run_export(const ExportOptions& options);

}  // namespace rumi::tool
