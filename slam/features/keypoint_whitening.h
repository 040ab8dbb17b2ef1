// SPDX-License-Identifier: BSD-3-Clause
// In which direction the place of a keypoint is known. That of a corner is known in all; what a corner detector finds
// on an edge may lie anywhere along it, and the nearest of such keypoints is taken for the landmark: it agrees with
// whatever was predicted.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace rumi {

// By the structure tensor of the 9 x 9 pixels around `at`, an 8-bit image's pixel with 5 more on every side: the
// covariance of a place is proportional to its inverse (Kanazawa and Kanatani, "Do We Really Have to Consider
// Covariance Matrices for Image Features?", ICCV 2001). Returns the symmetric matrix that makes errors in pixels
// comparable: 1 across an edge, 1/6 at least along it; the identity for corners.
Eigen::Matrix2f keypoint_whitening(const cv::Mat& image, const cv::Point2f& at);

}  // namespace rumi
