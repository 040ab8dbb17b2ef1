// SPDX-License-Identifier: BSD-3-Clause
// Projects the map into a panel of the picture.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "viewer_offscreen/scene/scene.h"

namespace rumi::viewer_offscreen {

// The plane that fits a trajectory best. The columns of `axes` are the first and the second direction in the plane and
// the normal, on the side that is up for the cameras. They are a right-handed rotation.
struct PrincipalPlane {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  double floor = 0;   // height of the grid: distance from `center` along the normal
  double extent = 1;  // largest extent of the trajectory along the axes
};
PrincipalPlane principal_plane(const std::vector<const SubmapView*>& submaps);

// Maps points of the map to pixels of the picture: (x, y) = (X, Y) / W with (X, Y, W) = matrix * (map, 1).
class Projection {
 public:
  using Matrix = Eigen::Matrix<double, 3, 4>;

  // Returns a parallel projection. It looks along the plane's normal (elevation 90 degrees) or from a lower elevation,
  // turned by `azimuth_rad`. The trajectories and the landmarks, without outliers, fill the panel.
  static Projection parallel(const PrincipalPlane& plane, double azimuth_rad, double elevation_rad,
                             const cv::Rect& panel, const std::vector<const SubmapView*>& submaps);
  // Returns a perspective projection from behind and above a camera onto what it sees, with a level horizon.
  static Projection follow(const PrincipalPlane& plane, const SE3& map_from_cam, const cv::Rect& panel);

  // Returns a point's pixel. The point must be in front of the viewer.
  cv::Point2d operator()(const Eigen::Vector3d& map) const;
  // Shortens the line from a to b to the part in front of the viewer. Returns false if there is none.
  bool clip(Eigen::Vector3d* a, Eigen::Vector3d* b) const;
  const Matrix& matrix() const { return matrix_; }
  // Returns the pixels per unit across the panel; nullopt for a perspective, which has no single scale.
  std::optional<double> scale() const { return scale_; }

 private:
  double depth(const Eigen::Vector3d& map) const { return matrix_.row(2) * map.homogeneous(); }
  Matrix matrix_ = Matrix::Zero();
  double near_ = 0;
  std::optional<double> scale_;
};

// Returns 1, 2 or 5 times a power of ten, near `length`.
double round_length(double length);

}  // namespace rumi::viewer_offscreen
