// SPDX-License-Identifier: BSD-3-Clause
// The arguments of `rumi up`: its flags, and the options that follow from them and from CONFIG.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/command_line/options.h"
#include "base/result.h"
#include "rumi/run/all_options.h"

namespace rumi::tool {

struct UpArguments {
  std::string first, second;  // CONFIG, INPUT, or one of them
  std::string config, input, snapshot;
  std::optional<std::string> asked_snapshot;
  UpOptions up;  // from flags; empty: not given
  std::vector<std::string> settings;
  std::vector<std::string> camera_settings;  // from flags, for camera_driver
  std::string calibration;                   // --camera without INPUT: the calibration of images from elsewhere
  bool fresh = false, verbose = false, quiet = false;
};

// True if the database is a file, and not in memory.
bool is_file(const std::string& database);

// Tells CONFIG and INPUT from each other; either may be missing. An Error if there are two of one.
Result<> sort_out(UpArguments* arguments);
// Fills all options from CONFIG and the flags. An Error if an option or a flag is wrong.
Result<> read_options(UpArguments* arguments, AllOptions* options, OptionTable* table);

}  // namespace rumi::tool
