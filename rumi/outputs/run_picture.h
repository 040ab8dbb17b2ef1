// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace rumi::tool {

// trajectory.png of the map.db in the folder, drawn by `program view` (this program): a process of its own and a time
// limit, because OpenGL may wait for ever for what it does not get, such as a thread, and may break off. Returns why
// there is none, or an empty string.
std::string draw_run_picture(const std::string& folder, const std::string& program = "/proc/self/exe");

}  // namespace rumi::tool
