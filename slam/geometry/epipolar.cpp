// SPDX-License-Identifier: BSD-3-Clause
#include "slam/geometry/epipolar.h"

#include <Eigen/Dense>
#include <cmath>
#include <limits>

namespace rumi {

Eigen::Matrix3d fundamental_matrix(const Camera& camera, const SE3& b_from_a) {
  Eigen::Matrix3d k_inverse;
  k_inverse << 1 / camera.fx, 0, -camera.cx / camera.fx, 0, 1 / camera.fy, -camera.cy / camera.fy, 0, 0, 1;
  return k_inverse.transpose() * skew(b_from_a.translation) * b_from_a.rotation.toRotationMatrix() * k_inverse;
}

Eigen::Matrix3d essential_matrix(const SE3& b_from_a) {
  return skew(b_from_a.translation) * b_from_a.rotation.toRotationMatrix();
}

double sampson_distance(const Eigen::Matrix3d& essential, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d line_b = essential * a, line_a = essential.transpose() * b;
  const double length2 = line_b.head<2>().squaredNorm() + line_a.head<2>().squaredNorm();
  if (!(length2 > 1e-18)) return std::numeric_limits<double>::infinity();
  return std::abs(b.dot(line_b)) / std::sqrt(length2);
}

}  // namespace rumi
