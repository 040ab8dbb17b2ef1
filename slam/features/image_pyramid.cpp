// SPDX-License-Identifier: BSD-3-Clause
#include "slam/features/image_pyramid.h"

#include <opencv2/imgproc.hpp>

namespace rumi {

ImagePyramid::ImagePyramid(const cv::Mat& grey, int levels, double scale_factor) : images_{grey} {
  double scale = 1;
  for (int i = 1; i < levels; ++i) {
    scale *= scale_factor;
    const cv::Size size(cvRound(grey.cols / scale), cvRound(grey.rows / scale));
    if (size.empty()) break;
    cv::Mat smaller;
    cv::resize(images_.back(), smaller, size, 0, 0, cv::INTER_LINEAR);
    images_.push_back(smaller);
  }
}

}  // namespace rumi
