// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "base/result.h"

namespace rumi::tool {

// Draws trajectory.png of the map.db in the folder, by `program view` (the default is this program). That is a process
// of its own with a time limit, because OpenGL may crash, or wait for ever for a thread. An Error says why there is no
// picture.
Result<> draw_run_picture(const std::string& folder, const std::string& program = "/proc/self/exe");

}  // namespace rumi::tool
