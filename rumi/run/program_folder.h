// SPDX-License-Identifier: BSD-3-Clause
// Where the programs of the processes are. Installed, only `rumi` is on the PATH: names such as map_server and
// camera_driver are others', too (ROS has them).
#pragma once

#include <filesystem>

namespace rumi::tool {

// Of a `rumi` in the folder `bin`: the folder of the installed programs where there is one; else they are beside it, as
// in a build tree.
std::filesystem::path program_folder_of(const std::filesystem::path& bin);

// The folder of the `rumi` that runs.
std::filesystem::path own_folder();

}  // namespace rumi::tool
