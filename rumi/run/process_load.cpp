// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/run/process_load.h"

#include <fmt/format.h>

#include <cmath>

#include "bus/transport/bus.h"
#include "bus/transport/log_file.h"
#include "lcmtypes/rumi/process_status_t.hpp"

namespace rumi::tool {
namespace {

constexpr double kLeastInterval_s = 0.5;  // a status that follows sooner, as at a process's end, gives no rate

}  // namespace

Result<ProcessLoad> read_process_load(const std::string& log_file) {
  ProcessLoad load;
  std::map<std::string, process_status_t> counted;  // by process: the status with which the next rate begins
  int64_t first_us = 0;
  LogReader reader(log_file);
  while (const auto event = reader.next_on(channels::kStatus)) {
    process_status_t status;
    if (!Bus::decode(event->data, &status) || !plausible_utime(status.utime)) continue;
    if (counted.empty()) first_us = status.utime;
    const double at_s = 1e-6 * static_cast<double>(status.utime - first_us);
    load.memory_mb[status.process].emplace_back(at_s, static_cast<double>(status.rss_bytes) / 1e6);
    const auto [before, is_first] = counted.try_emplace(status.process, status);
    if (is_first) continue;
    const double wall_s = 1e-6 * static_cast<double>(status.utime - before->second.utime);
    const bool same_process = before->second.pid == status.pid && wall_s > 0;
    if (same_process && wall_s < kLeastInterval_s) continue;
    const double percent = 100 * (status.cpu_s - before->second.cpu_s) / wall_s;
    if (same_process && std::isfinite(percent)) load.cpu_percent[status.process].emplace_back(at_s, percent);
    before->second = status;
  }
  if (!counted.empty()) return load;
  if (!reader.error().empty()) return Error{reader.error()};
  return Error{fmt::format("no process tells its status in it (channel {})", channels::kStatus), log_file};
}

}  // namespace rumi::tool
