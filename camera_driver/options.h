// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "base/command_line/options.h"
#include "camera_driver/source/camera_options.h"

namespace rumi::camera_driver {

// What is wrong with them, naming the field and its value; empty if nothing.
std::string check(const CameraOptions& options);

void describe(OptionTable& table, CameraOptions& options);

}  // namespace rumi::camera_driver
