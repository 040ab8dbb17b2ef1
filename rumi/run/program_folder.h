// SPDX-License-Identifier: BSD-3-Clause
// Finds the programs of the processes. Installed, only `rumi` is on the PATH: other packages have programs named
// map_server and camera_driver, too (ROS).
#pragma once

#include <filesystem>

namespace rumi::tool {

// The folder of the programs for a `rumi` in the folder `bin`: that of the installed programs if it exists, else `bin`
// itself, as in a build tree.
std::filesystem::path program_folder_of(const std::filesystem::path& bin);

// The folder of the `rumi` that runs.
std::filesystem::path own_folder();

}  // namespace rumi::tool
