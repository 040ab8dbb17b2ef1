// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ctime>

namespace rumi {

// CPU seconds of the calling thread so far.
inline double thread_cpu_s() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace rumi
