// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

#include "slam/geometry/transform.h"

namespace rumi {

// Returns the point that camera a sees along ray_a and camera b along ray_b (rays (x/z, y/z, 1) in the cameras'
// frames), by linear least squares on the image-plane equations (Hartley and Zisserman, section 12.2, inhomogeneous).
// Returns nullopt for (nearly) parallel rays, and for a point that is not in front of both cameras.
std::optional<Eigen::Vector3d> triangulate(const SE3& a_from_world, const Eigen::Vector3d& ray_a,
                                           const SE3& b_from_world, const Eigen::Vector3d& ray_b);

// Returns the angle between the directions from the point to the two camera centres, in radians.
double parallax_rad(const Eigen::Vector3d& point, const Eigen::Vector3d& center_a, const Eigen::Vector3d& center_b);

// Returns the information (inverse covariance) that one observation gives about a point's position: none along the ray.
// `to_point` leads from the camera to the point; `sigma_rad` is the ray's standard deviation.
Eigen::Matrix3d sight_information(const Eigen::Vector3d& to_point, double sigma_rad);

}  // namespace rumi
