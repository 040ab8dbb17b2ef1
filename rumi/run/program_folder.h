// SPDX-License-Identifier: BSD-3-Clause
// Finds the programs of the processes. When installed, only `rumi` is on the PATH, because other packages (ROS) also
// have programs named map_server and camera_driver.
#pragma once

#include <filesystem>

namespace rumi::tool {

// Returns the folder of the programs for a `rumi` in the folder `bin`: that of the installed programs if it exists,
// else `bin` itself, as in a build tree.
std::filesystem::path program_folder_of(const std::filesystem::path& bin);

// Returns the folder of the `rumi` that is running.
std::filesystem::path own_folder();

}  // namespace rumi::tool
