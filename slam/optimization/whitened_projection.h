// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "slam/geometry/camera.h"

namespace rumi {

// Reprojection error of a keypoint in units of its standard deviation: whitening / sigma * (projection - pixel).
class WhitenedProjection {
 public:
  WhitenedProjection() = default;
  WhitenedProjection(const Camera& camera, const Eigen::Vector2d& pixel, double sigma_px,
                     const Eigen::Matrix2d& whitening)
      : scale_(whitening * Eigen::Vector2d(camera.fx, camera.fy).asDiagonal() / sigma_px),
        keypoint_(whitening * (pixel - Eigen::Vector2d(camera.cx, camera.cy)) / sigma_px) {}

  // Of a point in front of the camera, in its frame.
  Eigen::Vector2d error(const Eigen::Vector3d& point) const {
    return scale_ * (point.head<2>() / point.z()) - keypoint_;
  }
  Eigen::Matrix<double, 2, 3> derivative(const Eigen::Vector3d& point) const {
    Eigen::Matrix<double, 2, 3> d;
    d.leftCols<2>() = scale_ / point.z();
    d.col(2).noalias() = -d.leftCols<2>() * (point.head<2>() / point.z());
    return d;
  }

 private:
  Eigen::Matrix2d scale_;
  Eigen::Vector2d keypoint_;
};

}  // namespace rumi
