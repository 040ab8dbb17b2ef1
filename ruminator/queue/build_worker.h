// SPDX-License-Identifier: BSD-3-Clause
// Rebuilds one window at a time: in a thread of its own at low priority (live), or at once (replay).
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "base/running/worker.h"
#include "ruminator/rebuild/back_submap_builder.h"

namespace rumi::ruminator {

// build_back_submap() with its options bound.
using Builder = std::function<BuildResult(const WindowJob& job, const std::string& work_folder,
                                          const std::function<void(const BuildProgress&)>& progress,
                                          const std::atomic<bool>& cancel)>;

struct BuildTask {
  std::shared_ptr<const WindowJob> job;  // null: it is in the file
  std::string file;
  std::string work_folder;
};

struct BuildReport {
  BuildResult result;
  std::vector<uint8_t> submap;  // result.submap as a message; empty if there is none
  int broken_images = 0;        // in the file of the job, left out
};

class BuildWorker {
 public:
  // Without a thread, on_progress is called during start(), each time that take_progress() has news.
  BuildWorker(Builder builder, bool threaded, int nice, std::function<void()> on_progress);
  ~BuildWorker();  // cancels the build that is running
  BuildWorker(const BuildWorker&) = delete;
  BuildWorker& operator=(const BuildWorker&) = delete;

  // Only when not busy.
  void start(BuildTask task);
  // True from start() until the report is taken.
  bool busy() const { return busy_; }
  // The latest progress of this build, once. Without a thread it has no estimate of the remaining time: that depends on
  // the load of the machine, and runs must be repeatable.
  std::optional<BuildProgress> take_progress();
  std::optional<BuildReport> take_report();
  void cancel() { cancel_ = true; }

 private:
  void work(const BuildTask& task);
  void build(const WindowJob& job, const std::string& work_folder);
  void note(const BuildProgress& progress);

  Builder builder_;
  const bool threaded_;
  std::function<void()> on_progress_;
  std::atomic<bool> cancel_ = false;
  bool busy_ = false;
  std::mutex progress_mutex_;
  std::optional<BuildProgress> progress_;  // not yet taken
  BuildReport report_;                     // belongs to the thread until the worker is idle
  Worker worker_;                          // last, so that its thread ends first
};

}  // namespace rumi::ruminator
