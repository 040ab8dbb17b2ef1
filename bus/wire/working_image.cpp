// SPDX-License-Identifier: BSD-3-Clause
#include "bus/wire/working_image.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "bus/wire/image_codec.h"

namespace rumi {
namespace {

// Returns by how much decoding may reduce the image (1, 2, 4 or 8) without making it smaller than `working`: a JPEG is
// decoded much faster at a reduced size.
int largest_reduction(const Camera& camera, const Camera& working) {
  int reduction = 8;
  while (reduction > 1 && (camera.width % reduction || camera.height % reduction ||
                           camera.width / reduction < working.width || camera.height / reduction < working.height))
    reduction /= 2;
  return reduction;
}

}  // namespace

Camera working_camera(const Camera& camera, int max_side) {
  const int side = std::max(camera.width, camera.height);
  if (max_side <= 0 || side <= max_side) return camera;
  const double factor = static_cast<double>(max_side) / side;
  return camera.resized(static_cast<int>(std::lround(camera.width * factor)),
                        static_cast<int>(std::lround(camera.height * factor)));
}

Result<cv::Mat> decode_working_image(const image_t& image, const Camera& camera, const Camera& working) {
  if (image.width != camera.width || image.height != camera.height)
    return Error{fmt::format("it is {}x{} but the calibration is for {}x{}", image.width, image.height, camera.width,
                             camera.height)};
  Result<cv::Mat> grey = decode_reduced_grey(image, largest_reduction(camera, working));
  if (!grey || (grey->cols == working.width && grey->rows == working.height)) return grey;
  cv::Mat resized;
  cv::resize(*grey, resized, cv::Size(working.width, working.height), 0, 0, cv::INTER_AREA);
  return resized;
}

}  // namespace rumi
