// SPDX-License-Identifier: BSD-3-Clause
// The times of a video's frames, all of them before the first one is decoded.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace rumi {

struct VideoTimes {
  std::vector<int64_t> utimes;  // times of the frames in the order of showing; the least is 0
  std::vector<int64_t> stamps;  // the same as stored in the packets; empty: not each packet has its time of showing
  bool has_times = false;       // else all utimes are 0
  int64_t stored = 0;           // frames, those that are not shown included
  int64_t promised = 0;         // by the header; 0: it does not say
  bool is_promise_by_length = false;  // counted from how long the file should be
  bool ends_early = false;            // before its stream does, by the header
};

// Reads the times of one stream of the file. Decodes it only if the packets do not tell all times. Empty if the file
// cannot be read.
VideoTimes read_video_times(const std::filesystem::path& file, int stream);

}  // namespace rumi
