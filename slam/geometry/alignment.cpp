// SPDX-License-Identifier: BSD-3-Clause
#include "slam/geometry/alignment.h"

#include <Eigen/SVD>

namespace rumi {

std::optional<Sim3> umeyama(const std::vector<Eigen::Vector3d>& source, const std::vector<Eigen::Vector3d>& target,
                            bool with_scale) {
  const size_t n = source.size();
  if (n < 3 || target.size() != n) return std::nullopt;
  Eigen::Vector3d source_mean = Eigen::Vector3d::Zero(), target_mean = Eigen::Vector3d::Zero();
  for (size_t i = 0; i < n; ++i) {
    source_mean += source[i];
    target_mean += target[i];
  }
  source_mean /= static_cast<double>(n);
  target_mean /= static_cast<double>(n);
  if (!source_mean.allFinite() || !target_mean.allFinite()) return std::nullopt;

  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double source_variance = 0;
  for (size_t i = 0; i < n; ++i) {
    covariance += (target[i] - target_mean) * (source[i] - source_mean).transpose();
    source_variance += (source[i] - source_mean).squaredNorm();
  }
  if (!(source_variance > 1e-24 * (1 + source_mean.squaredNorm()))) return std::nullopt;

  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d sign = Eigen::Vector3d::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0) sign.z() = -1;  // else it would be a reflection
  const Eigen::Matrix3d r = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
  const double scale = with_scale ? svd.singularValues().dot(sign) / source_variance : 1.0;
  if (!(scale > 0)) return std::nullopt;
  return Sim3(scale, Eigen::Quaterniond(r), target_mean - scale * (r * source_mean));
}

}  // namespace rumi
