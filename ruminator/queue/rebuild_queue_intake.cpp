// SPDX-License-Identifier: BSD-3-Clause
// How windows enter the queue, from the node or from the spool, and which are dropped if there are too many.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/running/log.h"
#include "ruminator/queue/rebuild_queue.h"
#include "ruminator/window/window_message.h"

namespace rumi::ruminator {

void RebuildQueue::adopt() {
  last_adopted_us_ = bus_.now_us();
  for (const JobName name : spool_->built())
    if (!knows(name)) adopt_submap(name);
  for (const JobName name : spool_->waiting())
    if (!knows(name)) adopt_window(name);
}

void RebuildQueue::adopt_submap(JobName name) {
  std::optional<Spool::Claim> claim = spool_->claim(name);
  if (!claim || !spool_->is_built(name)) return;
  QueueEntry& entry = entries_.emplace_back();
  entry.name = name;
  entry.window.session = name.session;
  entry.window.id = name.window_id;
  entry.state = Built();
  entry.place = InSpool{std::move(claim)};
  entry.result = "rebuilt by an earlier ruminator, left in the spool";
}

void RebuildQueue::adopt_window(JobName name) {
  std::optional<Spool::Claim> claim = spool_->claim(name);
  if (!claim || !spool_->is_waiting(name)) return;
  const WindowJobFile file = read_window_manifest(spool_->window_file(name));
  QueueEntry& entry = entries_.emplace_back();
  entry.name = name;
  entry.window = file.job.window;
  entry.window.session = name.session;
  entry.window.id = name.window_id;
  std::string problem = file.ok() ? "" : file.error;
  if (problem.empty() && name_of(file.job.window) != name)
    problem = fmt::format("the file holds window {} of session {}", file.job.window.id, file.job.window.session);
  if (!problem.empty()) {
    entry.place = InSpool{std::move(claim)};
    return fail(std::prev(entries_.end()), problem);
  }
  log_info("window {}: {}, left in the spool, queued", to_string(name), describe(file.job.window));
  announce(entry);
}

// Puts the job into the spool or into memory. Returns nothing if the spool has the window already.
std::optional<RebuildQueue::Place> RebuildQueue::place(WindowJob job) {
  if (spool_) {
    std::string error;
    const Spool::Added added = spool_->add(job, &error);
    if (added == Spool::Added::kKnown) return std::nullopt;
    if (error != spool_problem_ && !error.empty()) log_error("{}; the window is kept in memory", error);
    spool_problem_ = error;
    if (added == Spool::Added::kAdded) return InSpool();
  }
  return InMemory{std::make_shared<const WindowJob>(std::move(job)), {}};
}

void RebuildQueue::add(WindowJob job) {
  QueueEntry entry;
  entry.name = name_of(job.window);
  entry.window = job.window;
  std::optional<Place> place_of_it = place(std::move(job));
  if (!place_of_it)
    return log_warning("window {} is in the spool already: another ruminator shares it", to_string(entry.name));
  entry.place = std::move(*place_of_it);
  // Without a thread, the bus's time stands still while a window is rebuilt.
  const int64_t resumed_utime_us = entry.window.resumed_utime_us;
  if (options_.build_thread && resumed_utime_us > 0 && frame_utime_us_ >= resumed_utime_us)
    entry.resumed_us = bus_.now_us() - (frame_utime_us_ - resumed_utime_us);
  log_debug("window {}: {}{}{}, queued", entry.window.id, describe(entry.window),
            entry.window.reason.empty() ? "" : ", ", entry.window.reason);
  announce(entries_.emplace_back(std::move(entry)));
  limit();
  if (!options_.build_thread) tick(bus_.now_us());
}

void RebuildQueue::refuse(const RuminationWindow& window, const std::string& reason) {
  log_warning("window {}: {}; failed: {}", window.id, describe(window), reason);
  QueueEntry entry;
  entry.window = window;
  publish(entry, window_t::FAILED, reason);
  ++failed_;
  BuildResult nothing;
  nothing.failure = reason;
  if (built_handler_) built_handler_(window, nothing);
}

// Drops windows that are too many, the oldest first, because the newest loss matters most.
void RebuildQueue::limit() {
  const auto waits = [](const QueueEntry& e) { return e.is<Waiting>(); };
  const auto holds_submap = [](const QueueEntry& e) { return e.holds_submap(); };
  while (true) {
    int64_t bytes = 0;
    for (const QueueEntry& e : entries_) bytes += e.image_bytes();
    const auto waiting = std::count_if(entries_.begin(), entries_.end(), waits);
    const bool is_large = waiting > 1 && bytes > options_.ring_mb * kBytesPerMb;
    if (waiting > options_.max_queued_windows || is_large) {
      drop(std::find_if(entries_.begin(), entries_.end(),
                        [&](const QueueEntry& e) { return waits(e) && (e.memory() || !is_large); }),
           fmt::format("dropped before it was rebuilt: {} windows wait", waiting));
    } else if (std::count_if(entries_.begin(), entries_.end(), holds_submap) > options_.max_queued_windows) {
      drop(std::find_if(entries_.begin(), entries_.end(), holds_submap), "map_server does not take its back submap");
    } else {
      return;
    }
  }
}

void RebuildQueue::drop(Entries::iterator entry, const std::string& reason) {
  if (claim(*entry))
    fail(entry, reason);
  else
    entries_.erase(entry);  // another process has it now
}

}  // namespace rumi::ruminator
