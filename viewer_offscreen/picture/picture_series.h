// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <opencv2/videoio.hpp>
#include <string>

namespace rumi::viewer_offscreen {

// Every picture: FOLDER/pictures/000001.png, 000002.png, ..., and as FOLDER/trajectory.mp4. The pictures of an earlier
// series are removed when this one begins, unless that was never ended, as when its process died: then this one goes on
// with them, and its video begins anew. While a series is not ended there is a file FOLDER/pictures/unfinished.
class PictureSeries {
 public:
  // fps: pictures shown in a second of the video. goes_on: false removes also pictures of a series that was not ended.
  PictureSeries(std::string folder, double fps, bool goes_on);
  // What is wrong (file, reason), or an empty string. Pictures must be of one size.
  std::string add(const cv::Mat& picture);
  // Ends the series and its video: before, that is no complete file. Nothing may be added afterwards.
  void finish();
  int64_t size() const { return size_; }  // those that it goes on with included

 private:
  std::string begin(cv::Size size);
  std::string take_over_or_remove();
  std::string pictures_, video_file_, unfinished_;  // folder, files
  double fps_;
  bool goes_on_;
  int64_t size_ = 0;
  bool begun_ = false;
  cv::VideoWriter video_;
  std::string video_error_;
};

}  // namespace rumi::viewer_offscreen
