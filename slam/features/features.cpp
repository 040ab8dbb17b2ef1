// SPDX-License-Identifier: BSD-3-Clause
#include "slam/features/features.h"

namespace rumi {

Eigen::Matrix2d Features::whitening(size_t keypoint) const {
  return (whitenings.empty() ? Eigen::Matrix2f::Identity() : whitenings[keypoint]).cast<double>();
}

void Features::undistort(const Camera& camera) {
  undistorted.resize(keypoints.size());
  for (size_t i = 0; i < keypoints.size(); ++i)
    undistorted[i] = camera.undistort(keypoints[i].pixel.cast<double>()).cast<float>();
}

void Features::move(size_t keypoint, const Eigen::Vector2f& pixel, const Camera& camera) {
  keypoints[keypoint].pixel = pixel;
  undistorted[keypoint] = camera.undistort(pixel.cast<double>()).cast<float>();
}

}  // namespace rumi
