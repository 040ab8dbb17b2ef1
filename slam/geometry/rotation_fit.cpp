// SPDX-License-Identifier: BSD-3-Clause
#include "slam/geometry/rotation_fit.h"

#include <Eigen/Dense>
#include <algorithm>

#include "slam/numeric/median.h"

namespace rumi {

std::optional<RotationFit> fit_rotation(std::vector<Eigen::Vector3d> a, std::vector<Eigen::Vector3d> b) {
  constexpr int kRounds = 10;
  constexpr double kSmallest = 5e-4;  // rad; smaller residuals are noise and have the same weight
  if (a.size() < 3 || a.size() != b.size()) return std::nullopt;
  for (Eigen::Vector3d& ray : a) ray.normalize();
  for (Eigen::Vector3d& ray : b) ray.normalize();
  RotationFit fit;
  std::vector<double> residuals(a.size(), kSmallest);
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix3d correlation = Eigen::Matrix3d::Zero();
    for (size_t i = 0; i < a.size(); ++i) correlation += b[i] * a[i].transpose() / std::max(residuals[i], kSmallest);
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(correlation, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Vector3d sign(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1);
    fit.b_from_a = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
    for (size_t i = 0; i < a.size(); ++i) residuals[i] = (fit.b_from_a * a[i] - b[i]).norm();
  }
  if (!fit.b_from_a.allFinite()) return std::nullopt;
  fit.median_residual_rad = median(&residuals);
  return fit;
}

Eigen::Quaterniond central_rotation(const std::vector<Eigen::Quaterniond>& rotations) {
  const auto sum_of_angles = [&rotations](const Eigen::Quaterniond& q) {
    double sum = 0;
    for (const Eigen::Quaterniond& other : rotations) sum += q.angularDistance(other);
    return sum;
  };
  return *std::min_element(rotations.begin(), rotations.end(),
                           [&](const auto& a, const auto& b) { return sum_of_angles(a) < sum_of_angles(b); });
}

}  // namespace rumi
