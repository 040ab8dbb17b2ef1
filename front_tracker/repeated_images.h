// SPDX-License-Identifier: BSD-3-Clause
// Recognizes images that repeat the one before with another time, because the camera, the driver or the recorder stood
// still. Such an image does not tell where the camera is now.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>

namespace rumi::front_tracker {

class RepeatedImages {
 public:
  enum class Kind {
    kNew,
    kDoubled,  // first or second in a row: too short a time for the camera's motion to change
    kStill,    // third or later in a row
  };
  struct Row {
    int64_t images = 0;
    double begin_s = 0;  // time of its first image, counted from the first image of the session
  };

  // Judges the images in order of time. Logs the first doubled one, and long rows.
  Kind take(int64_t utime_us, const cv::Mat& grey);
  // Forgets the image before. Times are counted from the next image.
  void begin_session();

  int64_t doubled() const { return doubled_; }
  int64_t still() const { return still_; }
  const Row& longest() const { return longest_; }
  // Returns "28 images are the same as the one before; the longest row: 30 from 1.33 s on"; empty if no image stood
  // still.
  std::string text() const;

 private:
  void tell(Kind kind) const;

  cv::Mat last_;
  int64_t first_utime_us_ = INT64_MIN;
  int64_t doubled_ = 0, still_ = 0;
  Row row_, longest_;
};

}  // namespace rumi::front_tracker
