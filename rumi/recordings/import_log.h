// SPDX-License-Identifier: BSD-3-Clause
// lcm log or ROS bag with images -> TUM-style folder: rgb/SECONDS.jpg or .png, rgb.txt, calibration.yaml.
#pragma once

#include <string>

#include "camera_driver/options.h"

namespace rumi::tool {

struct ImportOptions {
  std::string log;
  std::string folder;  // created; if it exists it must be empty
  camera_driver::CameraOptions camera;
};

// JPEG images are written as they are, all others as PNG. Progress and errors are printed on stderr. Returns the exit
// code. After an error the files so far stay, and the message names the folder.
int run_import(const ImportOptions& options);

}  // namespace rumi::tool
