// SPDX-License-Identifier: BSD-3-Clause
#include "slam/features/lens_mask.h"

#include <cmath>
#include <opencv2/core.hpp>

#include "slam/geometry/lens_fold.h"

namespace rumi {

ImageMask lens_mask(const Camera& camera) {
  const double radius = fold_radius(camera);
  if (!std::isfinite(radius)) return {};
  cv::Mat pixels(camera.height, camera.width, CV_8U);
  for (int y = 0; y < pixels.rows; ++y)
    for (int x = 0; x < pixels.cols; ++x) pixels.at<uchar>(y, x) = is_beyond_fold(camera, radius, x, y) ? 0 : 255;
  return ImageMask(pixels);
}

}  // namespace rumi
