// SPDX-License-Identifier: BSD-3-Clause
// Projects the map into a panel of the picture.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "viewer_offscreen/scene/scene.h"

namespace rumi::viewer_offscreen {

// The plane that fits a trajectory best. Columns of `axes`: first and second direction in the plane, and the normal (on
// the side that is up for the cameras). It is a right-handed rotation.
struct PrincipalPlane {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  double floor = 0;   // along the normal, from the center: where the grid lies
  double extent = 1;  // of the trajectory in the plane
};
PrincipalPlane principal_plane(const std::vector<const SubmapView*>& submaps);

// Takes points of the map to pixels of the picture: (x, y) = (X, Y) / W with (X, Y, W) = matrix * (map, 1).
class Projection {
 public:
  using Matrix = Eigen::Matrix<double, 3, 4>;

  // A parallel projection. It looks along the plane's normal (elevation 90 degrees) or from a lower elevation, turned
  // by azimuth, and fits the trajectories and the landmarks without their outliers.
  static Projection parallel(const PrincipalPlane& plane, double azimuth_rad, double elevation_rad,
                             const cv::Rect& panel, const std::vector<const SubmapView*>& submaps);
  // A perspective projection from behind and above a camera onto what it sees, with a level horizon.
  static Projection follow(const PrincipalPlane& plane, const SE3& map_from_cam, const cv::Rect& panel);

  // The point must be in front of the viewer.
  cv::Point2d operator()(const Eigen::Vector3d& map) const;
  // Cuts off what is behind the viewer. Returns false if nothing is left.
  bool clip(Eigen::Vector3d* a, Eigen::Vector3d* b) const;
  const Matrix& matrix() const { return matrix_; }
  // Pixels per unit across the panel. A perspective has no single scale, so there it is empty.
  std::optional<double> scale() const { return scale_; }

 private:
  double depth(const Eigen::Vector3d& map) const { return matrix_.row(2) * map.homogeneous(); }
  Matrix matrix_ = Matrix::Zero();
  double near_ = 0;
  std::optional<double> scale_;
};

// 1, 2 or 5 times a power of ten, near `length`.
double round_length(double length);

}  // namespace rumi::viewer_offscreen
