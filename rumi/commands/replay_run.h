// SPDX-License-Identifier: BSD-3-Clause
// A replay from its options to its folder of outputs.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "base/result.h"
#include "rumi/outputs/map_file.h"
#include "rumi/run/all_options.h"
#include "rumi/run/replay.h"
#include "rumi/windows/window_report.h"

namespace rumi::tool {

struct ReplayRun {
  std::string input, out;
  std::string log = {};  // lcm log to write; empty: none
  AllOptions options = {};
  std::string options_yaml = {};   // as the user asked for them, for run.json
  bool colours_of_videos = false;  // colour map.ply, for which a video is decoded once more
  // Ends the recording when it becomes true; the part so far is written. May be null.
  const std::atomic<bool>* stop = nullptr;
  bool is_only_one = true;  // the process has no other run, so its peak of memory is that of the run
  std::function<void(const ReplayProgress&)> on_progress = {};  // after every image
};

struct ReplayOutcome {
  Result<> written;                     // an Error if the run could not begin, or not everything was written
  std::string warning;                  // something went wrong, though everything was written
  bool stopped = false;                 // ended by ReplayRun::stop
  std::vector<std::string> complaints;  // why not all of the recording is in the result, though it was computed
  AtlasCounts counts;
  std::vector<std::string> notes;     // see print_summary()
  std::vector<std::string> left_out;  // what the map lacks and why, a line each
  std::vector<WindowRow> windows;     // in the order in which they were rebuilt
  int64_t images = 0, total = -1;     // played, and in the recording (-1: nobody knows)
  int64_t begin_us = 0;               // of the first image
  double wall_s = 0;
};

// Throws std::runtime_error with a message for the user if the input or an option is no good.
ReplayOutcome run_replay(const ReplayRun& run);

}  // namespace rumi::tool
