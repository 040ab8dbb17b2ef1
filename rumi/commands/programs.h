// SPDX-License-Identifier: BSD-3-Clause
// `rumi camera_driver ARGUMENTS...`: the processes by the one command that is on the PATH.
#pragma once

#include <array>
#include <string>

namespace rumi::tool {

inline constexpr std::array kPrograms = {"camera_driver", "front_tracker", "ruminator", "map_server",
                                         "viewer_offscreen"};

// This process becomes the program that argv[1] names, with all that follows. Returns where it does not: why that could
// not be started, or nothing where argv[1] names none.
std::string become_program(char** argv);

}  // namespace rumi::tool
