// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/queue/build_worker.h"

#include <fmt/format.h>

#include <utility>

#include "bus/transport/bus.h"
#include "bus/wire/submap_update.h"

namespace rumi::ruminator {

BuildWorker::BuildWorker(Builder builder, bool threaded, int nice, ProgressHandler on_progress)
    : builder_(std::move(builder)), on_progress_(std::move(on_progress)), worker_(threaded, nice) {}

BuildWorker::~BuildWorker() { cancel_ = true; }

void BuildWorker::start(BuildTask task) {
  busy_ = true;
  cancel_ = false;
  report_ = {};
  worker_.post([this, task = std::move(task)] { work(task); });
}

std::optional<BuildReport> BuildWorker::take_report() {
  if (!busy_ || worker_.pending() > 0) return std::nullopt;
  busy_ = false;
  if (const Worker::Broken broken = worker_.take_broken(); broken.count > 0) {
    report_.result = {};
    report_.result.failure = fmt::format("rebuilding broke off: {}", broken.reason);
    report_.submap.clear();
  }
  return std::move(report_);
}

void BuildWorker::work(const BuildTask& task) {
  WindowJobFile file;
  if (!task.job) {
    file = read_window_job(task.file);
    report_.broken_images = file.broken_images;
    report_.unreadable = file.error;
    if (!file.ok()) return;
  }
  report_.result = builder_(task.job ? *task.job : file.job, task.work_folder, on_progress_, cancel_);
  if (!report_.result.submap) return;
  const submap_update_t update = make_submap_update(*report_.result.submap, 0);
  // map_server would refuse what is not consistent, again and again.
  Submap copy;
  copy.key = report_.result.submap->key;
  const Result<> applied = apply_submap_update(update, &copy);
  if (applied)
    report_.submap = encode_message(update);
  else
    report_.result.failure = fmt::format("the back submap is not consistent: {}", applied.error_text());
}

}  // namespace rumi::ruminator
