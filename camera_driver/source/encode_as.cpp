// SPDX-License-Identifier: BSD-3-Clause
#include "camera_driver/source/encode_as.h"

#include "bus/wire/image_codec.h"
#include "bus/wire/jpeg_image.h"

namespace rumi::camera_driver {

std::optional<image_t> encode_as(image_t image, const CameraOptions& options, std::string* error) {
  const bool is_grey = image.pixelformat == image_t::PIXEL_FORMAT_GRAY;
  if (options.encoding == "auto") return image;
  if (options.encoding == "grey" && is_grey) return image;
  if (options.encoding == "rgb" && image.pixelformat == image_t::PIXEL_FORMAT_RGB) return image;
  if (options.encoding == "jpeg" && image.pixelformat == image_t::PIXEL_FORMAT_MJPEG) return image;

  const bool want_grey = options.encoding == "grey" || (options.encoding == "jpeg" && is_grey);
  const cv::Mat pixels = want_grey ? decode_grey(image, error) : decode_bgr(image, error);
  if (pixels.empty()) return std::nullopt;
  if (options.encoding == "jpeg") return make_jpeg_image(image.utime, pixels);
  return want_grey ? make_grey_image(image.utime, pixels) : make_rgb_image(image.utime, pixels);
}

}  // namespace rumi::camera_driver
