// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/queue/queued_windows.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/running/log.h"
#include "ruminator/window/window_message.h"

namespace rumi::ruminator {

QueuedWindows::QueuedWindows(Bus& bus, const std::string& spool, int64_t max_failed_bytes) : announcer_(bus) {
  if (spool.empty()) return;
  Result<std::unique_ptr<Spool>> opened = Spool::open(spool, max_failed_bytes);
  if (opened) {
    spool_ = std::move(*opened);
  } else {
    spool_problem_ = opened.error_text();
    log_error("{}; windows are kept in memory", spool_problem_);
  }
}

QueuedWindows::Entries::iterator QueuedWindows::find(JobName name) {
  return std::find_if(entries_.begin(), entries_.end(), [&](const QueueEntry& e) { return e.name == name; });
}

QueuedWindows::Entries::iterator QueuedWindows::building() {
  return std::find_if(entries_.begin(), entries_.end(), [](const QueueEntry& e) { return e.is<Building>(); });
}

void QueuedWindows::note_stored(const Result<>& stored, const std::string& instead) {
  const std::string problem = stored.error_text();
  if (!problem.empty() && problem != spool_problem_) log_error("{}; {}", problem, instead);
  spool_problem_ = problem;
}

bool QueuedWindows::claim(QueueEntry& entry) {
  InSpool* const spooled = entry.spooled();
  if (!spooled || spooled->claim) return true;
  spooled->claim = spool_->claim(entry.name);
  if (spooled->claim && !spool_->is_waiting(entry.name)) spooled->claim.reset();
  return spooled->claim.has_value();
}

void QueuedWindows::fail(Entries::iterator entry, const std::string& reason) {
  std::optional<std::string> kept;
  if (entry->is_claimed()) kept = spool_->fail(entry->name, reason);
  log_warning("window {}: {}: failed{}: {}{}", entry->window.id, describe(entry->window),
              entry->build_s > 0 ? fmt::format(" after {:.1f} s", entry->build_s) : "", reason,
              kept ? "; kept as " + *kept : "");
  announce_failure(*entry, reason);
  entries_.erase(entry);
}

void QueuedWindows::announce_failure(const QueueEntry& entry, const std::string& reason) {
  announcer_.publish(entry, window_t::FAILED, reason);
  ++failed_;
}

}  // namespace rumi::ruminator
