// SPDX-License-Identifier: BSD-3-Clause
#include "camera_driver/source/encode_as.h"

#include <opencv2/imgproc.hpp>

#include "bus/wire/image_codec.h"
#include "bus/wire/jpeg_image.h"

namespace rumi::camera_driver {

Result<image_t> encode_as(image_t image, const CameraOptions& options) {
  const bool is_grey = image.pixelformat == image_t::PIXEL_FORMAT_GRAY;
  if (options.encoding == "auto") return image;
  if (options.encoding == "grey" && is_grey) return image;
  if (options.encoding == "rgb" && image.pixelformat == image_t::PIXEL_FORMAT_RGB) return image;
  if (options.encoding == "jpeg" && image.pixelformat == image_t::PIXEL_FORMAT_MJPEG) return image;

  const bool want_grey = options.encoding == "grey" || (options.encoding == "jpeg" && is_grey);
  const Result<cv::Mat> pixels = want_grey ? decode_grey(image) : decode_bgr(image);
  if (!pixels) return pixels.error();
  return encode_pixels(image.utime, *pixels, options);
}

image_t encode_pixels(int64_t utime_us, const cv::Mat& pixels, const CameraOptions& options) {
  if (options.encoding == "jpeg") return make_jpeg_image(utime_us, pixels);
  if (pixels.channels() == 3) return make_rgb_image(utime_us, pixels);
  if (options.encoding != "rgb") return make_grey_image(utime_us, pixels);
  cv::Mat bgr;
  cv::cvtColor(pixels, bgr, cv::COLOR_GRAY2BGR);
  return make_rgb_image(utime_us, bgr);
}

}  // namespace rumi::camera_driver
