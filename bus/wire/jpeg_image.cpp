// SPDX-License-Identifier: BSD-3-Clause
#include "bus/wire/jpeg_image.h"

#include <opencv2/imgcodecs.hpp>

#include "bus/wire/image_codec.h"

namespace rumi {

image_t make_jpeg_image(int64_t utime_us, const cv::Mat& image, int quality) {
  std::vector<uint8_t> jpeg;
  cv::imencode(".jpg", image, jpeg, {cv::IMWRITE_JPEG_QUALITY, quality});
  return wrap_jpeg(utime_us, image.cols, image.rows, std::move(jpeg));
}

}  // namespace rumi
