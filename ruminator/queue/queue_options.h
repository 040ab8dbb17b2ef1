// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "ruminator/rebuild/build_options.h"

namespace rumi::ruminator {

inline constexpr int64_t kBytesPerMb = 1'000'000;

struct RebuildQueueOptions {
  BuildOptions build;
  int ring_mb = 256;                 // most megabytes of images in memory
  int max_queued_windows = 16;       // most complete windows that wait; if there are more, the oldest is dropped
  bool rebuild = true;               // false: windows are only announced
  bool build_thread = true;          // false: rebuilds at once, as in a replay
  std::string spool = "rumi-spool";  // folder; empty: windows are kept in memory
  std::string scratch;  // folder for rebuilding windows in memory, if no temporary folder can be used; not an option
  int failed_mb = 500;  // most megabytes of failed windows that the spool keeps
  int build_tries = 3;  // most tries to rebuild one window
  double retry_s = 30;  // time to the next try to rebuild a window, or to send a back submap, s
};

}  // namespace rumi::ruminator
