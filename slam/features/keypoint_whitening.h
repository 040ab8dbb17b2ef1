// SPDX-License-Identifier: BSD-3-Clause
// How precisely a keypoint's pixel is known in each direction. A corner is known well in all directions. A keypoint on
// an edge may have been detected anywhere along it. Matching takes the keypoint nearest to the prediction, so one on an
// edge seems to agree with any prediction.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace rumi {

// Returns the symmetric matrix that makes errors in pixels comparable: it weighs them by 1 across an edge and by at
// least 1/6 along it, and is the identity for corners. The covariance of a keypoint's pixel is proportional to the
// inverse of the structure tensor, here of the 9 x 9 pixels around `at` (Kanazawa and Kanatani, "Do We Really Have to
// Consider Covariance Matrices for Image Features?", ICCV 2001). `image` has 8 bits; `at` is at least 5 pixels from its
// border.
Eigen::Matrix2f keypoint_whitening(const cv::Mat& image, const cv::Point2f& at);

}  // namespace rumi
