// SPDX-License-Identifier: BSD-3-Clause
#include "bus/process/only_one.h"

#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "base/this_process/process_name.h"

namespace rumi {
namespace {

constexpr int64_t kSettledUs = 3'000'000;  // after so long every process has published its status, even a busy one

int64_t age_us(const process_status_t& status) { return status.utime - status.started_utime; }

bool is_alive(int32_t pid) { return pid > 0 && (kill(pid, 0) == 0 || errno == EPERM); }

bool is_ours(const process_status_t& status) { return status.pid == getpid() && status.host == host_name(); }

}  // namespace

process_status_t starting_status(const std::string& process, int64_t now_us, int64_t started_us) {
  process_status_t status{};
  status.utime = now_us;
  status.process = process;
  status.host = host_name();
  status.pid = getpid();
  status.version = version();
  status.state = process_status_t::STARTING;
  status.started_utime = started_us;
  return status;
}

bool is_of_another(const process_status_t& status) {
  if (is_ours(status) || status.state == process_status_t::STOPPING) return false;
  return status.host != host_name() || is_alive(status.pid);
}

std::string describe(const process_status_t& status) {
  const std::string who = fmt::format("{}, pid {} on {}", status.process, status.pid, status.host);
  return age_us(status) <= 0 ? who : fmt::format("{}, for {:.0f} s", who, 1e-6 * static_cast<double>(age_us(status)));
}

OnlyOne::OnlyOne(Bus& bus, std::string process, std::string publishes)
    : bus_(bus), process_(std::move(process)), publishes_(std::move(publishes)), started_us_(bus.now_us()) {
  bus.subscribe<process_status_t>(channels::kStatus, {}, [this](const process_status_t& status) { on_status(status); });
}

void OnlyOne::ask() {
  process_status_t status = starting_status(process_, bus_.now_us(), started_us_);
  if (!publishes_.empty()) status.channels.push_back({publishes_, 0, 0, 0, 0});
  status.nchannels = static_cast<int32_t>(status.channels.size());
  bus_.publish(channels::kStatus, status);
}

bool OnlyOne::is_rival(const process_status_t& status) const {
  if (status.process != process_ || !is_of_another(status)) return false;
  return publishes_.empty() ||
         std::any_of(status.channels.begin(), status.channels.end(),
                     [this](const channel_count_t& channel) { return channel.channel == publishes_; });
}

// True if the other process began before this one. If the clock was set back meanwhile, a process that has run for long
// may seem to begin in the future: it counts as the earlier one.
bool OnlyOne::was_before_us(const process_status_t& status) const {
  const int64_t ours = bus_.now_us() - started_us_, theirs = age_us(status);
  if (theirs < 0 || theirs > ours) return true;
  return theirs == ours && std::pair(status.host, status.pid) < std::pair(host_name(), static_cast<int32_t>(getpid()));
}

void OnlyOne::on_status(const process_status_t& status) {
  const bool asks = status.state == process_status_t::STARTING;
  if (asks && status.process == kAsksEverybody && is_of_another(status)) asked_ = true;
  if (!is_rival(status)) return;
  if (asks) asked_ = true;
  const int64_t age_us = bus_.now_us() - started_us_;
  const bool settled = age_us >= kSettledUs || age_us < 0;
  const std::string on = publishes_.empty() ? "" : fmt::format(", and publishes on {}", publishes_);
  const char* another = publishes_.empty() ? "a bus of its own with --channel-prefix NAME"
                                           : "a channel of its own with --channel NAME, or --channel-prefix NAME";
  if (!settled && was_before_us(status)) {
    problem_ = fmt::format(
        "another {} is on this bus ({}{}): that one goes on, this one ends. Stop that one first, or "
        "give this one {}",
        process_, describe(status), on, another);
  } else if (settled && !asks && std::exchange(warned_of_, status.pid) != status.pid) {
    warning_ = fmt::format(
        "another {} is on this bus ({}{}): what both say will be mixed up. Stop one of them, or give "
        "it {}",
        process_, describe(status), on, another);
  }
}

bool OnlyOne::take_question() { return std::exchange(asked_, false); }
std::string OnlyOne::take_warning() { return std::exchange(warning_, {}); }

}  // namespace rumi
