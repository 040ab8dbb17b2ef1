// SPDX-License-Identifier: BSD-3-Clause
// Why a recording gave no map, as far as its images tell.
#pragma once

#include <string>

#include "camera_driver/source/camera_options.h"

namespace rumi::tool {

// Looks at some images of the part that was played. One sentence, with what to do.
std::string why_no_map(const std::string& recording, const camera_driver::CameraOptions& options);

}  // namespace rumi::tool
