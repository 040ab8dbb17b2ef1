// SPDX-License-Identifier: BSD-3-Clause
// What `rumi up` is asked for: its flags, and the options that follow from them and from CONFIG.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/command_line/options.h"
#include "rumi/run/all_options.h"

namespace rumi::tool {

struct UpArguments {
  std::string first, second;  // CONFIG, INPUT, or one of them
  std::string config, input, snapshot;
  std::optional<std::string> asked_snapshot;
  UpOptions up;  // what flags say; empty: nothing
  std::vector<std::string> settings;
  std::vector<std::string> camera_settings;  // by flags, for a camera_driver
  std::string calibration;                   // --camera without INPUT: of images from elsewhere
  bool fresh = false, verbose = false, quiet = false;
};

// In a file, and not only in memory.
bool is_file(const std::string& database);

// Tells CONFIG and INPUT from each other, of which each may be left out. Returns what is wrong, or nothing.
std::string sort_out(UpArguments* arguments);
// Fills all options from CONFIG and the flags. Returns what is wrong, or nothing.
std::string read_options(UpArguments* arguments, AllOptions* options, OptionTable* table);

}  // namespace rumi::tool
