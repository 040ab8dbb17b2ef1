// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/queue/build_worker.h"

#include <fmt/format.h>

#include <utility>

#include "bus/transport/bus.h"
#include "bus/wire/submap_update.h"

namespace rumi::ruminator {

BuildWorker::BuildWorker(Builder builder, bool threaded, int nice, std::function<void()> on_progress)
    : builder_(std::move(builder)),
      threaded_(threaded),
      on_progress_(std::move(on_progress)),
      worker_(threaded, nice) {}

BuildWorker::~BuildWorker() { cancel_ = true; }

void BuildWorker::start(BuildTask task) {
  busy_ = true;
  cancel_ = false;
  report_ = {};
  {
    const std::scoped_lock lock(progress_mutex_);
    progress_.reset();
  }
  worker_.post([this, task = std::move(task)] { work(task); });
}

void BuildWorker::note(const BuildProgress& progress) {
  {
    const std::scoped_lock lock(progress_mutex_);
    progress_ = progress;
    if (!threaded_) progress_->remaining_s = -1;
  }
  if (!threaded_) on_progress_();
}

std::optional<BuildProgress> BuildWorker::take_progress() {
  const std::scoped_lock lock(progress_mutex_);
  return std::exchange(progress_, std::nullopt);
}

std::optional<BuildReport> BuildWorker::take_report() {
  if (!busy_ || worker_.pending() > 0) return std::nullopt;
  busy_ = false;
  if (const Worker::Broken broken = worker_.take_broken(); broken.count > 0) {
    report_.result = {};
    report_.result.submap = Error{fmt::format("rebuilding broke off: {}", broken.reason)};
    report_.submap.clear();
  }
  return std::move(report_);
}

void BuildWorker::work(const BuildTask& task) {
  if (task.job) return build(*task.job, task.work_folder);
  const Result<WindowJobFile> file = read_window_job(task.file);
  if (!file) {
    report_.result.submap = file.error();
    return;
  }
  report_.broken_images = file->broken_images;
  build(file->job, task.work_folder);
}

void BuildWorker::build(const WindowJob& job, const std::string& work_folder) {
  report_.result = builder_(
      job, work_folder, [this](const BuildProgress& progress) { note(progress); }, cancel_);
  if (!report_.result.submap) return;
  // Checks the submap like map_server, which would refuse an inconsistent one again and again.
  const submap_update_t update = make_submap_update(*report_.result.submap, 0);
  Submap copy;
  copy.key = report_.result.submap->key;
  if (const Result<> applied = apply_submap_update(update, &copy); !applied)
    report_.result.submap = Error{fmt::format("the back submap is not consistent: {}", applied.error_text())};
  else
    report_.submap = encode_message(update);
}

}  // namespace rumi::ruminator
