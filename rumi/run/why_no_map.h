// SPDX-License-Identifier: BSD-3-Clause
// Finds out from a recording's images why it gave no map.
#pragma once

#include <string>

#include "camera_driver/source/camera_options.h"

namespace rumi::tool {

// Looks at some images of the part that was played. Returns one sentence that also says what to do.
std::string why_no_map(const std::string& recording, const camera_driver::CameraOptions& options);

}  // namespace rumi::tool
