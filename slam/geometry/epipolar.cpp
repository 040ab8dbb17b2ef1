// SPDX-License-Identifier: BSD-3-Clause
#include "slam/geometry/epipolar.h"

#include <Eigen/Dense>

namespace rumi {

Eigen::Matrix3d fundamental_matrix(const Camera& camera, const SE3& b_from_a) {
  Eigen::Matrix3d k_inverse;
  k_inverse << 1 / camera.fx, 0, -camera.cx / camera.fx, 0, 1 / camera.fy, -camera.cy / camera.fy, 0, 0, 1;
  return k_inverse.transpose() * skew(b_from_a.translation) * b_from_a.rotation.toRotationMatrix() * k_inverse;
}

}  // namespace rumi
