// SPDX-License-Identifier: BSD-3-Clause
// The times of a video's frames. OpenCV tells those of the packets, which in a video with B frames come in another
// order than the frames.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace rumi::camera_driver {

struct VideoTimes {
  std::vector<int64_t> utimes;  // of each frame that is shown, in that order; the least is 0
  bool has_times = false;       // else all are 0
  int64_t stored = 0;           // frames, those that are not shown included
  int64_t promised = 0;         // by the header; 0: it does not say
};

// Reads the packets of the first video stream, without decoding them. Empty if the file cannot be read.
VideoTimes read_video_times(const std::filesystem::path& file);

}  // namespace rumi::camera_driver
