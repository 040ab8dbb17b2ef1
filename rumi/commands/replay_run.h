// SPDX-License-Identifier: BSD-3-Clause
// A replay, from its options to its folder of outputs.
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
  bool colours_of_videos = false;  // colour map.ply even if a video must be decoded a second time for that
  // Ends the replay when it becomes true; the outputs of the part so far are written. May be null.
  const std::atomic<bool>* stop = nullptr;
  bool is_only_one = true;  // this process has no other run, so its peak memory is the run's
  std::function<void(const ReplayProgress&)> on_progress = {};  // called after every image
};

struct ReplayOutcome {
  Result<> written;                     // an Error if the run could not begin, or if an output could not be written
  std::string warning;                  // says what went wrong, although everything was written
  bool stopped = false;                 // ended by ReplayRun::stop
  std::vector<std::string> complaints;  // why the result lacks a part of the recording, although the run succeeded
  AtlasCounts counts;
  std::vector<std::string> notes;     // see print_summary()
  std::vector<std::string> left_out;  // what the map lacks and why, one line each
  std::vector<WindowRow> windows;     // in the order in which they were rebuilt
  int64_t images = 0, total = -1;     // images played, and in the recording (-1: unknown)
  int64_t begin_us = 0;               // time of the first image
  double wall_s = 0;
};

// Throws std::runtime_error, with a message for the user, if the input or an option is wrong.
ReplayOutcome run_replay(const ReplayRun& run);

}  // namespace rumi::tool
