// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace rumi::tool {

// What the processes of a live system needed over time. Points are (seconds since the first status, value).
struct ProcessLoad {
  using Points = std::vector<std::pair<double, double>>;
  std::map<std::string, Points> cpu_percent, memory_mb;  // by process
};

// From RUMI_STATUS of an lcm log (lcm-logger). A process that is started again goes on under its name. Empty, with the
// reason in *error, if the log cannot be read or nobody told his status; what comes before damage is taken.
ProcessLoad read_process_load(const std::string& log_file, std::string* error);

}  // namespace rumi::tool
