// SPDX-License-Identifier: BSD-3-Clause
// The arguments of `rumi up`: its flags, and the options that result from them and from CONFIG.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/command_line/options.h"
#include "base/result.h"
#include "rumi/run/all_options.h"

namespace rumi::tool {

struct UpArguments {
  std::string first, second;  // CONFIG and INPUT in any order; either may be missing
  std::string config, input, snapshot;
  std::optional<std::string> asked_snapshot;
  UpOptions up;  // from flags; a field is empty if its flag was not given
  std::vector<std::string> settings;
  std::vector<std::string> camera_settings;  // from flags, for camera_driver
  std::string calibration;  // --camera without INPUT: the calibration of images that another process publishes
  bool fresh = false, verbose = false, quiet = false;
};

// True if the database is a file, false if it is in memory.
bool is_file(const std::string& database);

// Tells by the names which of `first` and `second` is CONFIG and which is INPUT. An Error if there are two of one kind,
// or if --output is empty.
Result<> sort_out(UpArguments* arguments);
// Fills all options from CONFIG and the flags. An Error if an option or a flag is wrong.
Result<> read_options(UpArguments* arguments, AllOptions* options, OptionTable* table);

}  // namespace rumi::tool
