// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <opencv2/videoio.hpp>
#include <string>

#include "base/result.h"

namespace rumi::viewer_offscreen {

// Writes each picture as FOLDER/pictures/000001.png, 000002.png, ..., and all of them as FOLDER/trajectory.mp4. When a
// series begins, it removes the pictures of an earlier one. But if the earlier series was not ended, because its
// process died, the new one goes on with its pictures, and only the video begins anew. Until a series is ended there is
// a file FOLDER/pictures/unfinished.
class PictureSeries {
 public:
  // `fps`: pictures per second of video. `goes_on`: if false, also the pictures of a series that was not ended are
  // removed.
  PictureSeries(std::string folder, double fps, bool goes_on);
  // All pictures must have the same size. Returns an Error with the file that cannot be written. If that is the video,
  // the picture was written all the same.
  Result<> add(const cv::Mat& picture);
  // Ends the series and its video, which is not a complete file before. Nothing may be added afterwards.
  void finish();
  int64_t size() const { return size_; }  // includes the pictures of the series that it goes on with

 private:
  Result<> begin(cv::Size size);
  Result<> take_over_or_remove();
  std::string pictures_, video_file_, unfinished_;  // a folder and two files
  double fps_;
  bool goes_on_;
  int64_t size_ = 0;
  bool begun_ = false;
  cv::VideoWriter video_;
  Result<> video_is_open_;
};

}  // namespace rumi::viewer_offscreen
