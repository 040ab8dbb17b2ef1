// SPDX-License-Identifier: BSD-3-Clause
// Converts an lcm log or a ROS bag to a folder as of TUM RGB-D: rgb/SECONDS.jpg or .png, rgb.txt, calibration.yaml.
#pragma once

#include <string>

#include "camera_driver/options.h"

namespace rumi::tool {

struct ImportOptions {
  std::string log;
  std::string folder;  // is created if it does not exist; must be empty
  camera_driver::CameraOptions camera;
};

// Writes JPEG images as they are, and all others as PNG. Prints progress and errors on stderr. Returns the exit code.
// After an error the files written so far remain, and the message names the folder.
int run_import(const ImportOptions& options);

}  // namespace rumi::tool
