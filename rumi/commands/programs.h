// SPDX-License-Identifier: BSD-3-Clause
// `rumi PROGRAM ARGUMENTS...` starts one of the system's processes, because `rumi` is the only one on the PATH.
#pragma once

#include <array>
#include <string>

#include "base/result.h"

namespace rumi::tool {

inline constexpr std::array kPrograms = {"camera_driver", "front_tracker", "ruminator", "map_server",
                                         "viewer_offscreen"};

// Turns this process into the program that argv[1] names, with the arguments that follow. Returns if argv[1] names no
// program; returns an Error if the program cannot be started.
Result<> become_program(char** argv);

}  // namespace rumi::tool
