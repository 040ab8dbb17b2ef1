// SPDX-License-Identifier: BSD-3-Clause
// The queue of windows whose frames are collected. Intake adds a window, it is rebuilt here, and Delivery sends its
// back submap. A window passes QUEUED, EXTRACTING, MATCHING and MAPPING, and ends PUBLISHED once map_server has stored
// its back submap, or FAILED. Jobs and back submaps are kept in the spool, or in memory if there is none.
#pragma once

#include <functional>
#include <string>

#include "base/result.h"
#include "bus/transport/bus.h"
#include "ruminator/queue/build_worker.h"
#include "ruminator/queue/delivery.h"
#include "ruminator/queue/intake.h"
#include "ruminator/queue/queue_options.h"
#include "ruminator/queue/queued_windows.h"

namespace rumi::ruminator {

class RebuildQueue {
 public:
  // Called after each attempt to rebuild a window.
  using BuiltHandler = std::function<void(const RuminationWindow&, const BuildResult&)>;

  // Adopts what an earlier process left in the spool. If the spool cannot be used, the log and the status give the
  // reason.
  RebuildQueue(Bus& bus, const RebuildQueueOptions& options, Builder builder, BuiltHandler on_built);

  void add(WindowJob job);
  // Announces that a window failed, because it cannot become a job.
  void refuse(const RuminationWindow& window, const std::string& reason);
  void tick(int64_t now_us);
  // Sets the time of the newest frame. Announcements contain it, and add() computes from it when tracking resumed.
  void set_frame_time(int64_t utime_us) { windows_.announcer().set_frame_time(utime_us); }

  // To be called when no more windows will be added. Waiting windows are rebuilt and published; no attempt is repeated.
  void finish();
  // Cancels the running build. If its window is in the spool, it stays there for the next start.
  void stop();
  // Returns true if, after finish(), all windows are built and their back submaps accepted, or refused once. After
  // stop(): if no build runs, and no submap is being sent any more.
  bool finished() const { return waits_for().empty(); }
  std::string waits_for() const;  // why finished() is false, for users

  int last_id(int64_t session) const { return windows_.spool() ? windows_.spool()->last_id(session) : 0; }
  int pending() const { return static_cast<int>(windows_.entries().size()); }
  std::string detail() const;  // the queue's state in one line, for users
  bool degraded() const { return !windows_.spool_problem().empty() || !delivery_.problem().empty(); }

 private:
  using Entry = QueuedWindows::Entries::iterator;

  void start_next(int64_t now_us);
  void start(Entry entry);
  Result<BuildTask> make_task(QueueEntry& entry);
  void take_progress();
  void take_report(int64_t now_us);
  void on_built(Entry entry, const BuildReport& report, int64_t now_us);
  void tell(const QueueEntry& entry, const BuildResult& result);
  void try_again_or_fail(Entry entry, const std::string& reason, int64_t now_us);
  void give_up(Entry entry, const std::string& reason);
  void tell_what_is_left(int64_t now_us);

  Bus& bus_;
  RebuildQueueOptions options_;
  BuiltHandler built_handler_;
  QueuedWindows windows_;
  Intake intake_;
  Delivery delivery_;
  int built_ = 0;
  int64_t last_told_us_ = 0;
  bool finishing_ = false, stopping_ = false;
  int64_t stopped_us_ = 0;
  BuildWorker worker_;  // the last member: its thread ends before the others are destroyed
};

}  // namespace rumi::ruminator
