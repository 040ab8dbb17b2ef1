// SPDX-License-Identifier: BSD-3-Clause
// The queue of windows whose frames are collected. A window goes through QUEUED, EXTRACTING, MATCHING and MAPPING. It
// ends PUBLISHED when map_server has stored its back submap, or FAILED. Jobs and back submaps are kept in the spool, or
// in memory if there is none.
#pragma once

#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "bus/transfer/chunked_transfer.h"
#include "bus/transport/bus.h"
#include "lcmtypes/rumi/window_t.hpp"
#include "ruminator/queue/build_worker.h"
#include "ruminator/queue/queue_entry.h"
#include "ruminator/queue/spool.h"
#include "ruminator/rebuild/build_options.h"

namespace rumi::ruminator {

inline constexpr int64_t kBytesPerMb = 1'000'000;

struct RebuildQueueOptions {
  BuildOptions build;
  int ring_mb = 256;                 // images kept in memory
  int max_queued_windows = 16;       // complete windows that wait; beyond it the oldest is dropped
  bool rebuild = true;               // false: windows are announced only
  bool build_thread = true;          // false: rebuild at once, as replay does
  std::string spool = "rumi-spool";  // folder; empty: windows wait in memory
  std::string scratch;               // folder to rebuild windows in memory if no temporary one can be used; no option
  int failed_mb = 500;               // kept in the spool of windows that could not be rebuilt
  int build_tries = 3;               // of one window
  double retry_s = 30;               // to the next try, of rebuilding or of sending to map_server
};

class RebuildQueue {
 public:
  // After every attempt to rebuild a window.
  using BuiltHandler = std::function<void(const RuminationWindow&, const BuildResult&)>;

  // Takes up what an earlier process left in the spool. If the spool cannot be used, the log and the status say so.
  RebuildQueue(Bus& bus, const RebuildQueueOptions& options, Builder builder, BuiltHandler on_built);

  void add(WindowJob job);
  // Announces a window that cannot become a job as failed.
  void refuse(const RuminationWindow& window, const std::string& reason);
  void tick(int64_t now_us);
  // The time of the newest frame. Announcements carry it, and add() computes from it when tracking resumed.
  void set_frame_time(int64_t utime_us) { frame_utime_us_ = std::max(frame_utime_us_, utime_us); }

  // Call it when no more windows will be added. Waiting windows are rebuilt and published; nothing is tried again.
  void finish();
  // Cancels the build that is running. The spool keeps its window for the next start.
  void stop();
  // After finish(): all windows are built, and published unless map_server refuses them. After stop(): no build runs.
  bool finished() const { return waits_for().empty(); }
  std::string waits_for() const;  // why it is not finished, for a person

  int last_id(int64_t session) const { return spool_ ? spool_->last_id(session) : 0; }
  int pending() const { return static_cast<int>(entries_.size()); }
  std::string detail() const;  // one line for a person
  bool degraded() const;

 private:
  using Entries = std::list<QueueEntry>;
  using Place = std::variant<InSpool, InMemory>;

  void adopt();
  void adopt_window(JobName name);
  void adopt_submap(JobName name);
  bool knows(JobName name) const;
  std::optional<Place> place(WindowJob job);
  void limit();
  void drop(Entries::iterator entry, const std::string& reason);
  void start_next(int64_t now_us);
  bool claim(QueueEntry& entry);
  void start(Entries::iterator entry);
  std::string make_task(QueueEntry& entry, BuildTask* task);
  void on_progress(const BuildProgress& progress);
  void take_progress();
  void take_report(int64_t now_us);
  void on_built(Entries::iterator entry, const BuildReport& report, int64_t now_us);
  void tell(const QueueEntry& entry, const BuildResult& result);
  void try_again_or_fail(Entries::iterator entry, const std::string& reason, int64_t now_us);
  void fail(Entries::iterator entry, const std::string& reason);
  void give_up(Entries::iterator entry, const std::string& reason);
  void leave_built(QueueEntry& entry);
  void store(QueueEntry& entry, std::vector<uint8_t> submap);
  void deliver(int64_t now_us);
  void send(QueueEntry& entry, std::vector<uint8_t> submap);
  void on_delivered(JobName name, const TransferResult& result);
  void on_refused(QueueEntry& entry, const std::string& reason);
  void announce(QueueEntry& entry, const std::string& note = {});
  void publish(const QueueEntry& entry, int8_t state, const std::string& reason);
  void announce_all(int64_t now_us);
  bool is_sending() const;
  Entries::iterator find(JobName name);
  Entries::iterator building();
  int64_t retry_us() const { return static_cast<int64_t>(options_.retry_s * 1e6); }

  Bus& bus_;
  RebuildQueueOptions options_;
  BuiltHandler built_handler_;
  std::unique_ptr<Spool> spool_;
  std::string spool_problem_;
  ChunkSender sender_;
  Entries entries_;  // in order of arrival
  std::string delivery_problem_;
  int built_ = 0, published_ = 0, failed_ = 0;
  int64_t frame_utime_us_ = 0;
  int64_t last_adopted_us_ = 0;
  int64_t last_told_us_ = 0;
  bool finishing_ = false, stopping_ = false;
  int64_t stopped_us_ = 0;

  std::mutex progress_mutex_;
  std::optional<BuildProgress> progress_;  // news of the worker, not yet taken
  BuildWorker worker_;                     // last: ends first
};

}  // namespace rumi::ruminator
