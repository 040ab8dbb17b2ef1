// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <string>

#include "tests/support/patience.h"
#include "tests/support/temporary_folder.h"

namespace rumi::testing {

// False also for a zombie: a process whose parent has died may stay one if nobody collects it.
inline bool is_running(pid_t pid) {
  const std::string stat = read_file("/proc/" + std::to_string(pid) + "/stat");
  const size_t name_end = stat.rfind(") ");
  return name_end != std::string::npos && stat[name_end + 2] != 'Z' && stat[name_end + 2] != 'X';
}

inline bool ends(pid_t pid) {
  return happens([pid] { return !is_running(pid); });
}

}  // namespace rumi::testing
