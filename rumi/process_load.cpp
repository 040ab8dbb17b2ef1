// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/process_load.h"

#include <fmt/format.h>

#include <cmath>

#include "bus/bus.h"
#include "bus/log_file.h"
#include "lcmtypes/rumi/process_status_t.hpp"

namespace rumi {

ProcessLoad read_process_load(const std::string& log_file, std::string* error) {
  ProcessLoad load;
  std::map<std::string, process_status_t> latest;
  int64_t first_us = 0;
  LogReader reader(log_file);
  while (const auto event = reader.next_on(channels::kStatus)) {
    process_status_t status;
    if (!Bus::decode(event->data, &status) || !plausible_utime(status.utime)) continue;
    if (latest.empty()) first_us = status.utime;
    const double at_s = 1e-6 * static_cast<double>(status.utime - first_us);
    load.memory_mb[status.process].emplace_back(at_s, static_cast<double>(status.rss_bytes) / 1e6);
    const auto before = latest.find(status.process);
    if (before != latest.end() && before->second.pid == status.pid && status.utime > before->second.utime) {
      const double wall_s = 1e-6 * static_cast<double>(status.utime - before->second.utime);
      const double percent = 100 * (status.cpu_s - before->second.cpu_s) / wall_s;
      if (std::isfinite(percent)) load.cpu_percent[status.process].emplace_back(at_s, percent);
    }
    latest[status.process] = status;
  }
  *error = latest.empty() && reader.error().empty()
               ? fmt::format("{}: no process tells its status in it (channel {})", log_file, channels::kStatus)
           : latest.empty() ? reader.error()
                            : "";
  return load;
}

}  // namespace rumi
