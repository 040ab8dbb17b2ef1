// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/resource.h>

#include <ctime>

namespace rumi {

inline double clock_s(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// Returns the CPU seconds so far of the calling thread.
inline double thread_cpu_s() { return clock_s(CLOCK_THREAD_CPUTIME_ID); }
// Returns the CPU seconds so far of all threads of the process, and of the child processes that it has waited for.
inline double process_cpu_s() {
  rusage children{};
  getrusage(RUSAGE_CHILDREN, &children);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return clock_s(CLOCK_PROCESS_CPUTIME_ID) + seconds(children.ru_utime) + seconds(children.ru_stime);
}

}  // namespace rumi
