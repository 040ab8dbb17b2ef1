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

// build_back_submap() with its options already given.
using Builder = std::function<BuildResult(const WindowJob& job, const std::string& work_folder,
                                          const std::function<void(const BuildProgress&)>& progress,
                                          const std::atomic<bool>& cancel)>;

struct BuildTask {
  std::shared_ptr<const WindowJob> job;  // null if the job must be read from `file`
  std::string file;
  std::string work_folder;
};

struct BuildReport {
  BuildResult result;
  std::vector<uint8_t> submap;  // result.submap as an encoded message; empty if the build failed
  int broken_images = 0;        // images left out because they were damaged in the job's file
};

class BuildWorker {
 public:
  // `on_progress` is called only without a thread: during start(), each time that take_progress() has something new.
  BuildWorker(Builder builder, bool threaded, int nice, std::function<void()> on_progress);
  ~BuildWorker();  // cancels the running build
  BuildWorker(const BuildWorker&) = delete;
  BuildWorker& operator=(const BuildWorker&) = delete;

  // To be called only when not busy().
  void start(BuildTask task);
  // True from start() until take_report() has returned the report.
  bool busy() const { return busy_; }
  // Returns the latest progress of this build, but only once; nullopt if there is nothing new. Without a thread it has
  // no estimate of the remaining time, because that would depend on the load of the machine, and replays must be
  // repeatable.
  std::optional<BuildProgress> take_progress();
  // Returns the report when the build has ended, and nullopt until then.
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
  std::optional<BuildProgress> progress_;  // progress that take_progress() has not returned yet
  BuildReport report_;                     // belongs to the thread while it works
  Worker worker_;                          // the last member: its thread ends before the others are destroyed
};

}  // namespace rumi::ruminator
