// SPDX-License-Identifier: BSD-3-Clause
// An image in the form in which it is to go out.
#pragma once

#include <optional>
#include <string>

#include "camera_driver/source/camera_options.h"
#include "lcmtypes/rumi/image_t.hpp"

namespace rumi::camera_driver {

// As options.encoding says; nothing, and why in *error, if its pixels are needed for that and cannot be had.
std::optional<image_t> encode_as(image_t image, const CameraOptions& options, std::string* error);

}  // namespace rumi::camera_driver
