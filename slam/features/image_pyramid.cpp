// SPDX-License-Identifier: BSD-3-Clause
#include "slam/features/image_pyramid.h"

#include <opencv2/imgproc.hpp>

namespace rumi {

ImagePyramid::ImagePyramid(const cv::Mat& grey, const std::vector<double>& scales, const ImageMask& mask)
    : images_{grey}, mask_(mask) {
  for (size_t i = 1; i < scales.size(); ++i) {
    const cv::Size size(cvRound(grey.cols / scales[i]), cvRound(grey.rows / scales[i]));
    if (size.empty()) break;
    cv::Mat smaller;
    cv::resize(images_.back(), smaller, size, 0, 0, cv::INTER_LINEAR);
    images_.push_back(smaller);
  }
}

}  // namespace rumi
