// SPDX-License-Identifier: BSD-3-Clause
// Does jobs one after another: in a thread of its own (live), or each at once when it is posted (replay). An exception
// ends the job, not the process.
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
  // Jobs that broke off.
  struct Broken {
    int64_t count = 0;
    std::string reason;  // reason of the last one
  };

  // `nice`: of the thread, and of the child processes that it starts, more than the process has.
  explicit Worker(bool threaded, int nice = 0);
  ~Worker();  // waits for the job at hand, forgets the others
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  // Hold no lock that the job needs.
  void post(Job job);
  // Jobs waiting or at work.
  int pending() const;
  void wait_until_idle();
  // The number since the last call.
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
