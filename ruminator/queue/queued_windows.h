// SPDX-License-Identifier: BSD-3-Clause
// The windows in the queue and where they lie: in the spool, or in memory if there is none. Intake, RebuildQueue and
// Delivery work on them in turn.
#pragma once

#include <list>
#include <memory>
#include <string>

#include "bus/transport/bus.h"
#include "ruminator/queue/announcer.h"
#include "ruminator/queue/queue_entry.h"
#include "ruminator/queue/spool.h"

namespace rumi::ruminator {

class QueuedWindows {
 public:
  using Entries = std::list<QueueEntry>;  // in order of arrival

  // `spool`: folder; empty: all windows lie in memory. If the folder cannot be used, the log and spool_problem() say
  // so.
  QueuedWindows(Bus& bus, const std::string& spool, int64_t max_failed_bytes);

  Entries& entries() { return entries_; }
  const Entries& entries() const { return entries_; }
  Entries::iterator find(JobName name);
  Entries::iterator building();  // the window that is being rebuilt, or end()
  Announcer& announcer() { return announcer_; }

  Spool* spool() { return spool_.get(); }  // null if there is none
  const Spool* spool() const { return spool_.get(); }
  // Remembers whether the spool could store something last. `instead`, for the log: what happens if it could not.
  void note_stored(const Result<>& stored, const std::string& instead);
  const std::string& spool_problem() const { return spool_problem_; }

  // Takes the right to work on the window, unless this process has it. False if another process works on it, or has
  // rebuilt it.
  bool claim(QueueEntry& entry);
  // Ends a window that cannot be rebuilt or sent: announces it, moves its job to failed/ and removes the entry.
  void fail(Entries::iterator entry, const std::string& reason);
  // Announces a failure and counts it. The entry, if it is in the queue, stays.
  void announce_failure(const QueueEntry& entry, const std::string& reason);
  int failed() const { return failed_; }  // so far

 private:
  Announcer announcer_;
  std::unique_ptr<Spool> spool_;
  std::string spool_problem_;
  Entries entries_;
  int failed_ = 0;
};

}  // namespace rumi::ruminator
