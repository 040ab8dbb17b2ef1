// SPDX-License-Identifier: BSD-3-Clause
// `rumi camera_driver ARGUMENTS...`: starts a process by the one command that is on the PATH.
#pragma once

#include <array>
#include <string>

#include "base/result.h"

namespace rumi::tool {

inline constexpr std::array kPrograms = {"camera_driver", "front_tracker", "ruminator", "map_server",
                                         "viewer_offscreen"};

// This process becomes the program that argv[1] names, with the arguments that follow. Returns if argv[1] names no
// program; an Error if the program cannot be started.
Result<> become_program(char** argv);

}  // namespace rumi::tool
