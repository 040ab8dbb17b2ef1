// SPDX-License-Identifier: BSD-3-Clause
// Options of commands that read a recording from its beginning to its end.
#pragma once

#include <string>
#include <vector>

#include "base/command_line/command_line.h"
#include "camera_driver/source/camera_options.h"

namespace rumi::tool {

// Adds --set for the options of camera_driver.
void add_recording_settings(CommandLine* command, std::vector<std::string>* settings);
// Sets `options`. Throws WrongOptions, also for camera_driver.loop, with which the recording would never end.
void load_recording_options(const std::vector<std::string>& settings, camera_driver::CameraOptions* options);

}  // namespace rumi::tool
