// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <opencv2/videoio.hpp>
#include <string>

namespace rumi {

// Every picture: FOLDER/pictures/000001.png, 000002.png, ..., and all of them as FOLDER/trajectory.mp4. Those of an
// earlier series are removed when this one begins.
class PictureSeries {
 public:
  // fps: pictures shown in a second of the video.
  PictureSeries(std::string folder, double fps);
  // What is wrong (file, reason), or an empty string. Pictures must be of one size.
  std::string add(const cv::Mat& picture);
  // Ends the video: before, it is no complete file. Nothing may be added afterwards.
  void finish() { video_.release(); }
  int64_t size() const { return size_; }

 private:
  std::string begin(cv::Size size);
  std::string folder_;
  double fps_;
  int64_t size_ = 0;
  bool begun_ = false;
  cv::VideoWriter video_;
  std::string video_error_;
};

}  // namespace rumi
