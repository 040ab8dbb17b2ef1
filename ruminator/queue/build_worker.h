// SPDX-License-Identifier: BSD-3-Clause
// Rebuilds one window at a time: in a thread of its own at low priority (live), or at once (replay).
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/running/worker.h"
#include "ruminator/rebuild/back_submap_builder.h"

namespace rumi::ruminator {

// As build_back_submap, its options bound.
using Builder = std::function<BuildResult(const WindowJob& job, const std::string& work_folder,
                                          const std::function<void(const BuildProgress&)>& progress,
                                          const std::atomic<bool>& cancel)>;

struct BuildTask {
  std::shared_ptr<const WindowJob> job;  // or null, and the file that it is in
  std::string file;
  std::string work_folder;
};

struct BuildReport {
  BuildResult result;
  std::vector<uint8_t> submap;  // on the wire; empty if it failed
  int broken_images = 0;        // of the job, left out
  std::string unreadable;       // why the job could not be read
};

class BuildWorker {
 public:
  using ProgressHandler = std::function<void(const BuildProgress&)>;

  // on_progress is called where the work is done.
  BuildWorker(Builder builder, bool threaded, int nice, ProgressHandler on_progress);
  ~BuildWorker();  // calls off what is under way
  BuildWorker(const BuildWorker&) = delete;
  BuildWorker& operator=(const BuildWorker&) = delete;

  // Only when not busy.
  void start(BuildTask task);
  // Started, and its report not yet taken.
  bool busy() const { return busy_; }
  std::optional<BuildReport> take_report();
  void cancel() { cancel_ = true; }

 private:
  void work(const BuildTask& task);

  Builder builder_;
  ProgressHandler on_progress_;
  std::atomic<bool> cancel_ = false;
  bool busy_ = false;
  BuildReport report_;  // the worker's until it is idle
  Worker worker_;       // last: its thread ends first
};

}  // namespace rumi::ruminator
