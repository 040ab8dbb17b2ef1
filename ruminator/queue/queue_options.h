// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "ruminator/rebuild/build_options.h"

namespace rumi::ruminator {

inline constexpr int64_t kBytesPerMb = 1'000'000;

struct RebuildQueueOptions {
  BuildOptions build;
  int ring_mb = 256;                 // images kept in memory
  int max_queued_windows = 16;       // complete windows that wait; beyond it the oldest is dropped
  bool rebuild = true;               // false: windows are announced only
  bool build_thread = true;          // false: rebuild at once, as replay does
  std::string spool = "rumi-spool";  // folder; empty: windows wait in memory
  std::string scratch;               // folder to rebuild windows in memory if no temporary one can be used; no option
  int failed_mb = 500;               // size of the failed windows that the spool keeps
  int build_tries = 3;               // of one window
  double retry_s = 30;               // to the next try of rebuilding, or of sending to map_server
};

}  // namespace rumi::ruminator
