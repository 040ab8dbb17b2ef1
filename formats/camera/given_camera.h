// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "slam/geometry/camera.h"

namespace rumi {

// Returns the camera of a calibration file that a user named for a process, and logs its notes; nullopt if `file` is
// empty. Throws std::runtime_error, with what to do, if the file cannot be read.
std::optional<Camera> read_given_camera(const std::string& file);

}  // namespace rumi
