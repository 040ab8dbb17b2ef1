// SPDX-License-Identifier: BSD-3-Clause
#include "slam/geometry/triangulation.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace rumi {

std::optional<Eigen::Vector3d> triangulate(const SE3& a_from_world, const Eigen::Vector3d& ray_a,
                                           const SE3& b_from_world, const Eigen::Vector3d& ray_b) {
  Eigen::Matrix<double, 4, 3> m;
  Eigen::Vector4d y;
  const auto add_rows = [&](int row, const SE3& pose, const Eigen::Vector3d& ray) {
    const Eigen::Matrix3d r = pose.rotation.toRotationMatrix();
    for (int i = 0; i < 2; ++i) {
      m.row(row + i) = r.row(i) - ray[i] * r.row(2);
      y[row + i] = ray[i] * pose.translation.z() - pose.translation[i];
    }
  };
  add_rows(0, a_from_world, ray_a);
  add_rows(2, b_from_world, ray_b);
  const Eigen::Matrix3d normal = m.transpose() * m;
  const Eigen::LDLT<Eigen::Matrix3d> ldlt(normal);
  const Eigen::Vector3d d = ldlt.vectorD();
  if (!(d.minCoeff() > 1e-10 * d.maxCoeff())) return std::nullopt;
  const Eigen::Vector3d point = ldlt.solve(m.transpose() * y);
  if (!point.allFinite() || !((a_from_world * point).z() > 0) || !((b_from_world * point).z() > 0)) return std::nullopt;
  return point;
}

double parallax_rad(const Eigen::Vector3d& point, const Eigen::Vector3d& center_a, const Eigen::Vector3d& center_b) {
  const Eigen::Vector3d a = center_a - point, b = center_b - point;
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

Eigen::Matrix3d sight_information(const Eigen::Vector3d& to_point, double sigma_rad) {
  const double d2 = to_point.squaredNorm();
  return (Eigen::Matrix3d::Identity() - to_point * to_point.transpose() / d2) / (sigma_rad * sigma_rad * d2);
}

}  // namespace rumi
