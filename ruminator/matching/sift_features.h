// SPDX-License-Identifier: BSD-3-Clause
// SIFT keypoints (Lowe, IJCV 2004) for the back process: slower than ORB, but they bridge blur, darkness and wide
// turns.
#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "slam/geometry/camera.h"

namespace rumi::ruminator {

using SiftDescriptor = std::array<uint8_t, 128>;  // RootSIFT (Arandjelovic and Zisserman, CVPR 2012), times 512

// All three have the same length; the keypoints of the largest scale come first.
struct SiftFeatures {
  std::vector<Eigen::Vector2f> undistorted;  // pixels without lens distortion
  std::vector<float> scale_px;               // radius of the region described
  std::vector<SiftDescriptor> descriptors;
  size_t size() const { return undistorted.size(); }
};

struct SiftOptions {
  int keypoints = 1000;              // per image, the strongest
  double contrast_threshold = 0.01;  // a quarter of OpenCV's: the images of a gap are blurred or dark
  // Of an image with fewer keypoints than `few_keypoints`, in a second try: it is very dark, or blind.
  double low_contrast_threshold = 0.004;
  int few_keypoints = 60;
};

// From an 8-bit grey image. Keypoints whose pixel the lens model cannot undistort are left out.
SiftFeatures extract_sift(const cv::Mat& grey, const Camera& camera, const SiftOptions& options);

}  // namespace rumi::ruminator
