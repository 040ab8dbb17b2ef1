// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/mapping/mapping_worker.h"

namespace rumi::front_tracker {

MappingWorker::MappingWorker(const Mapper& mapper, std::mutex& map_mutex, bool threaded)
    : mapper_(mapper), map_mutex_(map_mutex) {
  if (threaded) thread_ = std::thread([this] { run(); });
}

MappingWorker::~MappingWorker() {
  {
    const std::scoped_lock lock(mutex_);
    stop_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void MappingWorker::post(FrontSubmap* submap, int keyframe_id) {
  if (!thread_.joinable()) {
    mapper_.process(*submap, keyframe_id, map_mutex_);
    return;
  }
  {
    const std::scoped_lock lock(mutex_);
    queue_.emplace_back(submap, keyframe_id);
  }
  wake_.notify_all();
}

int MappingWorker::pending() const {
  const std::scoped_lock lock(mutex_);
  return static_cast<int>(queue_.size()) + (working_ ? 1 : 0);
}

void MappingWorker::wait_until_idle() {
  std::unique_lock lock(mutex_);
  wake_.wait(lock, [this] { return queue_.empty() && !working_; });
}

void MappingWorker::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    wake_.wait(lock, [this] { return stop_ || !queue_.empty(); });
    if (stop_) return;
    const auto [submap, keyframe_id] = queue_.front();
    queue_.pop_front();
    working_ = true;
    lock.unlock();
    mapper_.process(*submap, keyframe_id, map_mutex_);
    lock.lock();
    working_ = false;
    wake_.notify_all();
  }
}

}  // namespace rumi::front_tracker
