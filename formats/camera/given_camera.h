// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "slam/geometry/camera.h"

namespace rumi {

// The camera of a calibration file that a user named for a process; nothing if `file` is empty. Its notes are logged.
// Throws std::runtime_error, with what to do, if it cannot be read.
std::optional<Camera> read_given_camera(const std::string& file);

}  // namespace rumi
