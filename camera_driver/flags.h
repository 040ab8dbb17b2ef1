// SPDX-License-Identifier: BSD-3-Clause
// The flags that programs and commands which take a recording have in common: each is short for an option of the
// section camera_driver.
#pragma once

#include <string>
#include <vector>

#include "base/command_line/command_line.h"

namespace rumi::camera_driver {

// Adds those of the `flags` ("--every"); of all with an empty list. What is given of them is put among the settings for
// load_options(), which outlive parse().
void add_flags(CommandLine& command, const std::vector<std::string>& flags, std::vector<std::string>* settings);

}  // namespace rumi::camera_driver
