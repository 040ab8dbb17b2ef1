// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "base/command_line/options.h"
#include "base/result.h"
#include "camera_driver/source/camera_options.h"

namespace rumi::camera_driver {

// An Error names the option and its value.
Result<> check(const CameraOptions& options);

void describe(OptionTable& table, CameraOptions& options);

}  // namespace rumi::camera_driver
