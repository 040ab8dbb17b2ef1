// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <opencv2/videoio.hpp>
#include <string>

#include "base/result.h"

namespace rumi::viewer_offscreen {

// Writes every picture as FOLDER/pictures/000001.png, 000002.png, ..., and all of them as FOLDER/trajectory.mp4. When a
// series begins it removes the pictures of an earlier one. If the earlier one was never ended, because its process
// died, the new one goes on with its pictures, and only the video begins anew. As long as a series is not ended there
// is a file FOLDER/pictures/unfinished.
class PictureSeries {
 public:
  // fps: pictures shown in a second of the video. goes_on: false removes the pictures of a series that was not ended
  // too.
  PictureSeries(std::string folder, double fps, bool goes_on);
  // Pictures must be of one size. An Error names the file that cannot be written; the picture may be there all the
  // same, without a video.
  Result<> add(const cv::Mat& picture);
  // Ends the series and its video, which is no complete file before. Nothing may be added afterwards.
  void finish();
  int64_t size() const { return size_; }  // includes the pictures that it goes on with

 private:
  Result<> begin(cv::Size size);
  Result<> take_over_or_remove();
  std::string pictures_, video_file_, unfinished_;  // folder, files
  double fps_;
  bool goes_on_;
  int64_t size_ = 0;
  bool begun_ = false;
  cv::VideoWriter video_;
  Result<> video_is_open_;
};

}  // namespace rumi::viewer_offscreen
