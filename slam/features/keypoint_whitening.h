// SPDX-License-Identifier: BSD-3-Clause
// The directions in which a keypoint's pixel is known. A corner is known in all directions. A keypoint that the
// detector finds on an edge may lie anywhere along it; matching takes the one nearest to the prediction, so that it
// seems to agree with any prediction.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace rumi {

// Uses the structure tensor of the 9 x 9 pixels around `at`, a pixel of an 8-bit image at least 5 pixels from its
// border: the covariance of the keypoint's pixel is proportional to the tensor's inverse (Kanazawa and Kanatani, "Do We
// Really Have to Consider Covariance Matrices for Image Features?", ICCV 2001). Returns the symmetric matrix that makes
// errors in pixels comparable: 1 across an edge and at least 1/6 along it; the identity for corners.
Eigen::Matrix2f keypoint_whitening(const cv::Mat& image, const cv::Point2f& at);

}  // namespace rumi
