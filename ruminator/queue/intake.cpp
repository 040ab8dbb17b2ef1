// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/queue/intake.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/running/due.h"
#include "base/running/log.h"
#include "ruminator/window/window_message.h"

namespace rumi::ruminator {
namespace {

constexpr int64_t kAdoptPeriodUs = 10'000'000;

}  // namespace

Intake::Intake(Bus& bus, QueuedWindows& windows, const RebuildQueueOptions& options)
    : bus_(bus), windows_(windows), options_(options) {
  if (windows_.spool()) adopt();
}

void Intake::tick(int64_t now_us) {
  if (windows_.spool() && is_due(now_us, last_adopted_us_, kAdoptPeriodUs)) adopt();
}

void Intake::adopt() {
  last_adopted_us_ = bus_.now_us();
  const auto is_new = [this](JobName name) { return windows_.find(name) == windows_.entries().end(); };
  for (const JobName name : windows_.spool()->built())
    if (is_new(name)) adopt_submap(name);
  for (const JobName name : windows_.spool()->waiting())
    if (is_new(name)) adopt_window(name);
}

void Intake::adopt_submap(JobName name) {
  std::optional<Spool::Claim> claim = windows_.spool()->claim(name);
  if (!claim || !windows_.spool()->is_built(name)) return;
  QueueEntry& entry = windows_.entries().emplace_back();
  entry.name = name;
  entry.window.session = name.session;
  entry.window.id = name.window_id;
  entry.state = Built();
  entry.place = InSpool{std::move(claim)};
  entry.result = "rebuilt by an earlier ruminator, left in the spool";
}

void Intake::adopt_window(JobName name) {
  std::optional<Spool::Claim> claim = windows_.spool()->claim(name);
  if (!claim || !windows_.spool()->is_waiting(name)) return;
  const Result<WindowJob> job = read_window_manifest(windows_.spool()->window_file(name));
  QueueEntry& entry = windows_.entries().emplace_back();
  entry.name = name;
  if (job) entry.window = job->window;
  entry.window.session = name.session;
  entry.window.id = name.window_id;
  std::string problem = job.error_text();
  if (job && name_of(job->window) != name)
    problem = fmt::format("the file holds window {} of session {}", job->window.id, job->window.session);
  if (!problem.empty()) {
    entry.place = InSpool{std::move(claim)};
    return windows_.fail(std::prev(windows_.entries().end()), problem);
  }
  log_info("window {}: {}, left in the spool, queued", to_string(name), describe(job->window));
  windows_.announcer().announce(entry);
}

// Puts the job into the spool, or else into memory. Returns nullopt if the spool has the window already.
std::optional<Intake::Place> Intake::place(WindowJob job) {
  if (Spool* const spool = windows_.spool()) {
    const Result<Spool::Added> added = spool->add(job);
    if (added && *added == Spool::Added::kKnown) return std::nullopt;
    windows_.note_stored(added ? Result<>() : added.error(), "the window is kept in memory");
    if (added) return InSpool();
  }
  return InMemory{std::make_shared<const WindowJob>(std::move(job)), {}};
}

bool Intake::add(WindowJob job) {
  QueueEntry entry;
  entry.name = name_of(job.window);
  entry.window = job.window;
  std::optional<Place> placed = place(std::move(job));
  if (!placed) {
    log_warning("window {} is in the spool already: another ruminator shares it", to_string(entry.name));
    return false;
  }
  entry.place = std::move(*placed);
  // Without a thread the bus's time stands still during a rebuild, so the delay since tracking resumed cannot be
  // measured.
  const int64_t resumed_utime_us = entry.window.resumed_utime_us;
  const int64_t frame_utime_us = windows_.announcer().frame_utime_us();
  if (options_.build_thread && resumed_utime_us > 0 && frame_utime_us >= resumed_utime_us)
    entry.resumed_us = bus_.now_us() - (frame_utime_us - resumed_utime_us);
  log_debug("window {}: {}{}{}, queued", entry.window.id, describe(entry.window),
            entry.window.reason.empty() ? "" : ", ", entry.window.reason);
  windows_.announcer().announce(windows_.entries().emplace_back(std::move(entry)));
  make_room();
  return true;
}

void Intake::refuse(const RuminationWindow& window, const std::string& reason) {
  log_warning("window {}: {}; failed: {}", window.id, describe(window), reason);
  QueueEntry entry;
  entry.window = window;
  windows_.announce_failure(entry, reason);
}

// Drops the oldest windows as long as there are too many, because the newest loss matters most.
void Intake::make_room() {
  const auto waits = [](const QueueEntry& e) { return e.is<Waiting>(); };
  const auto holds_submap = [](const QueueEntry& e) { return e.holds_submap(); };
  QueuedWindows::Entries& entries = windows_.entries();
  while (true) {
    int64_t bytes = 0;
    for (const QueueEntry& e : entries) bytes += e.image_bytes();
    const auto waiting = std::count_if(entries.begin(), entries.end(), waits);
    const bool is_large = waiting > 1 && bytes > options_.ring_mb * kBytesPerMb;
    if (waiting > options_.max_queued_windows || is_large) {
      drop(std::find_if(entries.begin(), entries.end(),
                        [&](const QueueEntry& e) { return waits(e) && (e.memory() || !is_large); }),
           fmt::format("dropped before it was rebuilt: {} windows wait", waiting));
    } else if (std::count_if(entries.begin(), entries.end(), holds_submap) > options_.max_queued_windows) {
      drop(std::find_if(entries.begin(), entries.end(), holds_submap), "map_server does not take its back submap");
    } else {
      return;
    }
  }
}

void Intake::drop(QueuedWindows::Entries::iterator entry, const std::string& reason) {
  if (windows_.claim(*entry))
    windows_.fail(entry, reason);
  else
    windows_.entries().erase(entry);  // another process has claimed it
}

}  // namespace rumi::ruminator
