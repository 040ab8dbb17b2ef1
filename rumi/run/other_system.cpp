// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/run/other_system.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

#include "base/this_process/process_name.h"
#include "bus/process/only_one.h"

namespace rumi::tool {
namespace {

constexpr int kDispatchMs = 10;

bool takes_a_place(const process_status_t& status, const WantedPlaces& wanted) {
  if (status.process != "camera_driver") return wanted.processes.contains(status.process);
  return !wanted.camera_channel.empty() &&
         std::any_of(status.channels.begin(), status.channels.end(),
                     [&](const channel_count_t& channel) { return channel.channel == wanted.camera_channel; });
}

bool asked_before_us(const process_status_t& status, int64_t started_us) {
  if (status.started_utime != started_us) return status.started_utime < started_us;
  return std::pair(status.host, status.pid) < std::pair(host_name(), static_cast<int32_t>(getpid()));
}

}  // namespace

Result<> find_other_system(Bus& bus, const WantedPlaces& wanted, std::chrono::milliseconds listen) {
  const int64_t started_us = bus.now_us();
  const auto ask = [&] { bus.publish(channels::kStatus, starting_status(kAsksEverybody, bus.now_us(), started_us)); };
  std::string found;
  bool ask_again = false;
  bus.subscribe<process_status_t>(channels::kStatus, {}, [&](const process_status_t& status) {
    if (!is_of_another(status)) return;
    const bool asks_too = status.process == kAsksEverybody;
    if (asks_too && !asked_before_us(status, started_us))
      ask_again = true;  // the other system may have begun to listen only after our question
    else if (asks_too || takes_a_place(status, wanted))
      found = describe(status);
  });
  ask();
  for (const auto end = std::chrono::steady_clock::now() + listen;
       found.empty() && std::chrono::steady_clock::now() < end;) {
    bus.dispatch(kDispatchMs);
    if (std::exchange(ask_again, false)) ask();
  }
  if (found.empty()) return {};
  return Error{fmt::format(
      "another system is on this bus ({}): it goes on, nothing was started here. Stop it first, or give this one a bus "
      "of "
      "its own with --set up.channel_prefix=NAME (and the same --channel-prefix for `rumi status` and the others)",
      found)};
}

}  // namespace rumi::tool
