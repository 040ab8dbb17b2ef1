// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

namespace rumi::camera_driver {

// What to do with a recording of another system that is not read (a ROS bag, a folder of one, ...), after the name of
// the file; empty: it is none of these.
std::string advice_on_foreign_recording(const std::filesystem::path& path);

}  // namespace rumi::camera_driver
