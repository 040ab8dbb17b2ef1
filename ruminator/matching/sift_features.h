// SPDX-License-Identifier: BSD-3-Clause
// SIFT keypoints (Lowe, IJCV 2004) for the back process: slower than ORB, but they bridge blur, darkness and wide
// turns.
#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "slam/features/image_mask.h"
#include "slam/geometry/camera.h"

namespace rumi::ruminator {

using SiftDescriptor = std::array<uint8_t, 128>;  // RootSIFT (Arandjelovic and Zisserman, CVPR 2012), times 512

// The vectors have the same length. The keypoints of the largest scale come first.
struct SiftFeatures {
  std::vector<Eigen::Vector2f> undistorted;  // pixels without lens distortion
  std::vector<float> scale_px;               // radius of the region described
  std::vector<SiftDescriptor> descriptors;
  size_t size() const { return undistorted.size(); }
};

constexpr int kSiftKeypoints = 1000;

// Finds the strongest keypoints of an 8-bit grey image. Leaves out those that the lens model cannot undistort, and
// those where the mask (of the image's size) leaves something out.
SiftFeatures extract_sift(const cv::Mat& grey, const Camera& camera, int max_keypoints = kSiftKeypoints,
                          const ImageMask& mask = {});

}  // namespace rumi::ruminator
