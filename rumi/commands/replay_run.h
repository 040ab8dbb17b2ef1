// SPDX-License-Identifier: BSD-3-Clause
// A replay from its options to its folder of outputs.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

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
  bool colours_of_videos = false;  // in map.ply; a video is decoded once more for them
  // Ends the recording where it becomes true; what there is is written. Null: nothing does.
  const std::atomic<bool>* stop = nullptr;
  bool is_only_one = true;  // in this process: then the peak of its memory is this run's
  std::function<void(const ReplayProgress&)> on_progress = {};  // after every image
};

struct ReplayOutcome {
  std::string error;                    // empty: all is written
  std::string warning;                  // what did not go as it should, though all is written
  bool stopped = false;                 // by ReplayRun::stop
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
