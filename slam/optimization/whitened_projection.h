// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "slam/geometry/camera.h"

namespace rumi {

// The reprojection error of a keypoint in units of its standard deviation: whitening / sigma * (projection - pixel).
class WhitenedProjection {
 public:
  WhitenedProjection() = default;
  WhitenedProjection(const Camera& camera, const Eigen::Vector2d& pixel, double sigma_px,
                     const Eigen::Matrix2d& whitening)
      : scale_(whitening * Eigen::Vector2d(camera.fx, camera.fy).asDiagonal() / sigma_px),
        keypoint_(whitening * (pixel - Eigen::Vector2d(camera.cx, camera.cy)) / sigma_px) {}

  // `point` is in the camera's frame, in front of the camera.
  Eigen::Vector2d error(const Eigen::Vector3d& point) const {
    return scale_ * (point.head<2>() / point.z()) - keypoint_;
  }
  Eigen::Matrix<double, 2, 3> derivative(const Eigen::Vector3d& point) const {
    Eigen::Matrix<double, 2, 3> d;
    d.leftCols<2>() = scale_ / point.z();
    d.col(2).noalias() = -d.leftCols<2>() * (point.head<2>() / point.z());
    return d;
  }

  // Computes the gradient by the point, weight * derivative^T * error, and the Gauss-Newton hessian, weight *
  // derivative^T * derivative.
  void normal_equations(const Eigen::Vector3d& point, const Eigen::Vector2d& error, double weight,
                        Eigen::Matrix3d* hessian, Eigen::Vector3d* gradient) const {
    const double iz = 1 / point.z();
    const Eigen::Vector2d ray = point.head<2>() * iz;
    // The derivative is scale_ / z * [1 0 -x/z; 0 1 -y/z].
    const Eigen::Matrix2d h = weight * iz * iz * (scale_.transpose() * scale_);
    const Eigen::Vector2d g = weight * iz * (scale_.transpose() * error), along = -h * ray;
    *hessian << h(0, 0), h(0, 1), along.x(), h(1, 0), h(1, 1), along.y(), along.x(), along.y(), -along.dot(ray);
    *gradient << g.x(), g.y(), -g.dot(ray);
  }

 private:
  Eigen::Matrix2d scale_;
  Eigen::Vector2d keypoint_;
};

}  // namespace rumi
