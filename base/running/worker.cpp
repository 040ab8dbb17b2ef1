// SPDX-License-Identifier: BSD-3-Clause
#include "base/running/worker.h"

#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "base/running/failures.h"
#include "base/running/log.h"

namespace rumi {

Worker::Worker(bool threaded, int nice) {
  if (threaded) thread_ = std::thread([this, nice] { loop(nice); });
}

Worker::~Worker() {
  {
    const std::scoped_lock lock(mutex_);
    stop_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void Worker::post(Job job) {
  if (!thread_.joinable()) return run(job);
  {
    const std::scoped_lock lock(mutex_);
    queue_.push_back(std::move(job));
  }
  wake_.notify_all();
}

int Worker::pending() const {
  const std::scoped_lock lock(mutex_);
  return static_cast<int>(queue_.size()) + (working_ ? 1 : 0);
}

void Worker::wait_until_idle() {
  std::unique_lock lock(mutex_);
  wake_.wait(lock, [this] { return queue_.empty() && !working_; });
}

Worker::Broken Worker::take_broken() {
  const std::scoped_lock lock(mutex_);
  return std::exchange(broken_, {});
}

void Worker::run(const Job& job) {
  std::string reason = thrown_by(job);
  if (reason.empty()) return;
  const std::scoped_lock lock(mutex_);
  ++broken_.count;
  broken_.reason = std::move(reason);
}

void Worker::loop(int nice) {
  // On Linux a thread has a niceness of its own; its children inherit it.
  const auto thread = static_cast<id_t>(gettid());
  if (nice != 0 && setpriority(PRIO_PROCESS, thread, getpriority(PRIO_PROCESS, thread) + nice) != 0)
    log_warning("a thread runs at normal priority: {}", std::strerror(errno));
  std::unique_lock lock(mutex_);
  while (true) {
    wake_.wait(lock, [this] { return stop_ || !queue_.empty(); });
    if (stop_) return;
    const Job job = std::move(queue_.front());
    queue_.pop_front();
    working_ = true;
    lock.unlock();
    run(job);
    lock.lock();
    working_ = false;
    wake_.notify_all();
  }
}

}  // namespace rumi
