// SPDX-License-Identifier: BSD-3-Clause
// Chooses the stream of a video file, and reads what its header says about the pictures.
#pragma once

#include <filesystem>
#include <opencv2/core/types.hpp>
#include <string>
#include <vector>

namespace rumi {

struct VideoChoice {
  int stream = -1;  // -1: the file is no video, or cannot be read
  bool is_interlaced = false;
  std::vector<std::string> notes;  // about several streams, and pixels that are not square
};

// Chooses a stream with one of the `wanted` sizes, else the largest; among equals, the one that FFmpeg finds best.
// Pictures of the cover count only if there is nothing else.
VideoChoice choose_video_stream(const std::filesystem::path& file, const std::vector<cv::Size>& wanted);

}  // namespace rumi
