// SPDX-License-Identifier: BSD-3-Clause
// The windows in the queue. Their data are in the spool, or in memory if there is no spool. Shared by Intake,
// RebuildQueue and Delivery.
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

  // `spool`: folder; empty: all windows are kept in memory. If the folder cannot be used, windows are kept in memory
  // too, and the log and spool_problem() give the reason.
  QueuedWindows(Bus& bus, const std::string& spool, int64_t max_failed_bytes);

  Entries& entries() { return entries_; }
  const Entries& entries() const { return entries_; }
  Entries::iterator find(JobName name);
  Entries::iterator building();  // the window that is being rebuilt, or end()
  Announcer& announcer() { return announcer_; }

  Spool* spool() { return spool_.get(); }  // null if there is no spool
  const Spool* spool() const { return spool_.get(); }
  // Notes whether the latest attempt to store something in the spool succeeded. `instead`: text for the log on what
  // happens to the data if not.
  void note_stored(const Result<>& stored, const std::string& instead);
  const std::string& spool_problem() const { return spool_problem_; }

  // Takes the right to work on the window, unless this process has it already. Returns false if another process works
  // on it, or it no longer waits.
  bool claim(QueueEntry& entry);
  // Ends a window that cannot be rebuilt or sent: moves its job to failed/, announces the failure and removes the
  // entry.
  void fail(Entries::iterator entry, const std::string& reason);
  // Announces and counts a failure. Does not remove the entry.
  void announce_failure(const QueueEntry& entry, const std::string& reason);
  int failed() const { return failed_; }  // failures announced so far

 private:
  Announcer announcer_;
  std::unique_ptr<Spool> spool_;
  std::string spool_problem_;
  Entries entries_;
  int failed_ = 0;
};

}  // namespace rumi::ruminator
