// SPDX-License-Identifier: BSD-3-Clause
// Images that are the one before once more, with another time: the camera, the driver or the recorder stood still. They
// carry no information, and a pose for them would be invented.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>

namespace rumi::front_tracker {

class RepeatedImages {
 public:
  struct Row {
    int64_t images = 0;
    double begin_s = 0;  // since the first image
  };
  // Images in order of time. True if the image is the one before. The first ones and long rows are said in the log.
  bool take(int64_t utime_us, const cv::Mat& grey);
  // Times begin anew.
  void begin_session();

  int64_t count() const { return count_; }
  const Row& longest() const { return longest_; }
  // "31 images are the same as the one before; the longest row, 30 images from 1.33 s on": empty where there are none.
  std::string text() const;

 private:
  void tell() const;

  cv::Mat last_;
  int64_t first_utime_us_ = INT64_MIN;
  int64_t count_ = 0;
  Row row_, longest_;
};

}  // namespace rumi::front_tracker
