// SPDX-License-Identifier: BSD-3-Clause
// Which images show the same place: each image becomes one vector (VLAD: Jegou et al., "Aggregating local descriptors
// into a compact image representation", CVPR 2010) of its SIFT descriptors. The visual words are those of the images
// themselves: no vocabulary comes from elsewhere.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "ruminator/matching/sift_features.h"
#include "slam/features/image_mask.h"
#include "slam/geometry/camera.h"

namespace rumi::ruminator {

class ImageSimilarity {
 public:
  // False, and the image is not taken, if it shows too little to be recognized. Images are numbered 0, 1, ... in the
  // order in which they are taken. `camera` is the grey image's.
  bool add(const cv::Mat& grey, const Camera& camera, const ImageMask& mask);
  // Computes the words and the vectors; call it once, after the last add(). Deterministic.
  void build();
  // From -1 to 1; 1 for the same image. After build().
  double similarity(size_t first, size_t second) const;
  size_t size() const { return descriptors_.size(); }

 private:
  cv::Mat words() const;
  Eigen::VectorXf vector_of(const cv::Mat& words, const std::vector<SiftDescriptor>& descriptors) const;

  std::vector<std::vector<SiftDescriptor>> descriptors_;  // freed by build()
  std::vector<Eigen::VectorXf> vectors_;
};

}  // namespace rumi::ruminator
