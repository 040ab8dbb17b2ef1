// SPDX-License-Identifier: BSD-3-Clause
// Reads the times of a video's frames, all of them before the first one is decoded.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace rumi {

struct VideoTimes {
  std::vector<int64_t> utimes;        // times of the frames in the order of showing; the least is 0
  std::vector<int64_t> stamps;        // the times as stored in the packets; empty if a packet lacks its time of
                                      // showing, or the file has no container
  bool has_times = false;             // else all utimes are 0
  int64_t stored = 0;                 // frames in the file, including those that are not shown
  int64_t promised = 0;               // frames that the header promises; 0: it does not say
  bool is_promise_by_length = false;  // the promise is computed from the length that the file should have
  bool ends_early = false;            // if frames are missing, they are missing at the end: the promise is computed
                                      // from the length, or the file ends before the length that its header gives
};

// Reads the times of one stream of the file. Decodes it only if the packets do not tell all times. Empty if the file
// cannot be read.
VideoTimes read_video_times(const std::filesystem::path& file, int stream);

}  // namespace rumi
