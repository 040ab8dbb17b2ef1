// SPDX-License-Identifier: BSD-3-Clause
// Does jobs one after another: in a thread of its own (live), or each within post() (replay). An exception ends its
// job, not the process.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

namespace rumi {

class Worker {
 public:
  using Job = std::function<void()>;
  // Jobs that ended with an exception.
  struct Broken {
    int64_t count = 0;
    std::string reason;  // reason of the last exception
  };

  // `nice` is added to the niceness of the thread and of the child processes that it starts.
  explicit Worker(bool threaded, int nice = 0);
  ~Worker();  // waits for the present job and drops the others
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  // The caller must not hold a lock that the job needs: without a thread the job runs in this call.
  void post(Job job);
  // Returns the number of jobs that wait or are at work.
  int pending() const;
  void wait_until_idle();
  // Returns the jobs that have thrown since the last call.
  Broken take_broken();

 private:
  void loop(int nice);
  void run(const Job& job);

  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<Job> queue_;
  bool working_ = false, stop_ = false;
  Broken broken_;
  std::thread thread_;
};

}  // namespace rumi
