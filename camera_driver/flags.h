// SPDX-License-Identifier: BSD-3-Clause
// The flags that all programs and commands that take a recording have in common. Each sets an option of the section
// camera_driver.
#pragma once

#include <string>
#include <vector>

#include "base/command_line/command_line.h"

namespace rumi::camera_driver {

// Adds the flags that `flags` names ("--every"), or all flags if it is empty. Flags that a user gives are appended to
// `settings` for load_options(); `settings` must outlive parse().
void add_flags(CommandLine& command, const std::vector<std::string>& flags, std::vector<std::string>* settings);

}  // namespace rumi::camera_driver
