// SPDX-License-Identifier: BSD-3-Clause
// From the map to a panel of the picture.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

#include "viewer_offscreen/scene.h"

namespace rumi {

// The plane that a trajectory lies in, as far as it does. Columns of `axes`: first and second direction in the plane,
// the normal (on the side that is up for the cameras). A right-handed rotation.
struct PrincipalPlane {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  double floor = 0;   // along the normal, from the center: where the grid lies
  double extent = 1;  // of the trajectory in the plane
};
PrincipalPlane principal_plane(const std::vector<const SubmapView*>& submaps);

// Parallel projection onto a panel.
class Projection {
 public:
  // Looks along the plane's normal (elevation 90 degrees) or from a lower elevation, turned by azimuth. Fitted to the
  // trajectories and to the landmarks without their outliers.
  Projection(const PrincipalPlane& plane, double azimuth_rad, double elevation_rad, const cv::Rect& panel,
             const std::vector<const SubmapView*>& submaps);
  cv::Point2d operator()(const Eigen::Vector3d& map) const {
    const Eigen::Vector3d p = map - origin_;
    return {panel_center_.x + scale_ * p.dot(right_), panel_center_.y - scale_ * p.dot(up_)};
  }
  double scale() const { return scale_; }  // pixels per unit

 private:
  Eigen::Vector3d origin_, right_, up_;
  cv::Point2d panel_center_;
  double scale_ = 1;
};

// 1, 2 or 5 times a power of ten, near `length`.
double round_length(double length);

}  // namespace rumi
