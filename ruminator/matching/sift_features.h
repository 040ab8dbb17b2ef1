// SPDX-License-Identifier: BSD-3-Clause
// SIFT keypoints (Lowe, IJCV 2004) for the back process. They are slower than ORB, but can be matched across blur,
// darkness and large rotations.
#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "slam/features/image_mask.h"
#include "slam/geometry/camera.h"

namespace rumi::ruminator {

using SiftDescriptor = std::array<uint8_t, 128>;  // RootSIFT (Arandjelovic and Zisserman, CVPR 2012), times 512

// Vectors of equal length. The keypoints of the largest scale come first.
struct SiftFeatures {
  std::vector<Eigen::Vector2f> undistorted;  // pixels without lens distortion
  std::vector<float> scale_px;               // radius of the described region
  std::vector<SiftDescriptor> descriptors;
  size_t size() const { return undistorted.size(); }
};

constexpr size_t kMinKeypoints = 50;  // an image with fewer shows nothing to be rebuilt
constexpr int kSiftKeypoints = 1000;

// Finds the strongest keypoints of an 8-bit grey image. Leaves out keypoints that the lens model cannot undistort, and
// those in or close to the masked part (the mask has the image's size).
SiftFeatures extract_sift(const cv::Mat& grey, const Camera& camera, int max_keypoints = kSiftKeypoints,
                          const ImageMask& mask = {});

}  // namespace rumi::ruminator
