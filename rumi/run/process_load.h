// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "base/result.h"

namespace rumi::tool {

// CPU and memory of the processes of a live system over time. A point is (seconds since the first status, value).
struct ProcessLoad {
  using Points = std::vector<std::pair<double, double>>;
  std::map<std::string, Points> cpu_percent, memory_mb;  // by process
};

// Reads RUMI_STATUS of an lcm log (lcm-logger). A process that was restarted goes on under its name. A damaged log is
// read up to the damage. An Error if nothing can be read, or if no process told its status.
Result<ProcessLoad> read_process_load(const std::string& log_file);

}  // namespace rumi::tool
