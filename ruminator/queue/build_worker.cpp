// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/queue/build_worker.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <exception>
#include <utility>

#include "base/log.h"
#include "bus/transport/bus.h"
#include "bus/wire/submap_update.h"

namespace rumi::ruminator {

BuildWorker::BuildWorker(Builder builder, bool threaded, int nice, ProgressHandler on_progress)
    : builder_(std::move(builder)), nice_(nice), on_progress_(std::move(on_progress)) {
  if (threaded) thread_ = std::thread([this] { run(); });
}

BuildWorker::~BuildWorker() {
  cancel_ = true;
  {
    const std::scoped_lock lock(mutex_);
    stop_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void BuildWorker::start(BuildTask task) {
  busy_ = true;
  cancel_ = false;
  if (!thread_.joinable()) {
    report_ = work(task);
    return;
  }
  {
    const std::scoped_lock lock(mutex_);
    task_ = std::move(task);
  }
  wake_.notify_all();
}

std::optional<BuildReport> BuildWorker::take_report() {
  const std::scoped_lock lock(mutex_);
  if (report_) busy_ = false;
  return std::exchange(report_, std::nullopt);
}

void BuildWorker::run() {
  // On Linux a thread has a niceness of its own; its children inherit it.
  if (setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), nice_) != 0)
    log_warning("rebuilding runs at normal priority: {}", std::strerror(errno));
  std::unique_lock lock(mutex_);
  while (true) {
    wake_.wait(lock, [this] { return stop_ || task_; });
    if (stop_) return;
    const BuildTask task = std::move(*task_);
    task_.reset();
    lock.unlock();
    BuildReport report = work(task);
    lock.lock();
    report_ = std::move(report);
  }
}

BuildReport BuildWorker::work(const BuildTask& task) {
  BuildReport report;
  try {
    WindowJobFile file;
    if (!task.job) {
      file = read_window_job(task.file);
      report.broken_images = file.broken_images;
      report.unreadable = file.error;
      if (!file.ok()) return report;
    }
    report.result = builder_(task.job ? *task.job : file.job, task.work_folder, on_progress_, cancel_);
    if (!report.result.submap) return report;
    const submap_update_t update = make_submap_update(*report.result.submap, 0);
    // map_server would refuse what is not consistent, again and again.
    Submap copy;
    copy.key = report.result.submap->key;
    const std::string problem = apply_submap_update(update, &copy);
    if (problem.empty())
      report.submap = encode_message(update);
    else
      report.result.failure = fmt::format("the back submap is not consistent: {}", problem);
  } catch (const std::exception& e) {
    report.result.failure = fmt::format("rebuilding broke off: {}", e.what());
  }
  return report;
}

}  // namespace rumi::ruminator
