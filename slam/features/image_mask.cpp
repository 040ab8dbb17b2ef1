// SPDX-License-Identifier: BSD-3-Clause
#include "slam/features/image_mask.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace rumi {

ImageMask::ImageMask(const cv::Mat& pixels) {
  if (pixels.empty() || cv::countNonZero(pixels) == static_cast<int>(pixels.total())) return;
  pixels_ = pixels.clone();
  cv::distanceTransform(pixels_, clearance_, cv::DIST_L2, cv::DIST_MASK_3);
}

bool ImageMask::allows(const Eigen::Vector2f& pixel, float margin_px) const {
  if (is_everything()) return true;
  const int x = std::clamp(cvRound(pixel.x()), 0, clearance_.cols - 1);
  const int y = std::clamp(cvRound(pixel.y()), 0, clearance_.rows - 1);
  return clearance_.at<float>(y, x) > margin_px;
}

double ImageMask::left_out() const {
  if (is_everything()) return 0;
  return 1 - static_cast<double>(cv::countNonZero(pixels_)) / static_cast<double>(pixels_.total());
}

ImageMask ImageMask::resized(const cv::Size& size) const {
  if (is_everything() || pixels_.size() == size) return *this;
  constexpr double kAll = 1 - 1e-6;  // least share of world of a pixel that shows the world; in floats, because bytes
                                     // would round a speck away
  cv::Mat world, smaller;
  cv::Mat(pixels_ != 0).convertTo(world, CV_32F, 1.0 / 255);
  cv::resize(world, smaller, size, 0, 0, cv::INTER_AREA);
  return ImageMask(smaller >= kAll);
}

ImageMask ImageMask::and_also(const ImageMask& other) const {
  if (is_everything()) return other;
  if (other.is_everything()) return *this;
  return ImageMask((pixels_ != 0) & (other.pixels_ != 0));
}

}  // namespace rumi
