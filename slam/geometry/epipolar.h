// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "slam/geometry/camera.h"
#include "slam/geometry/transform.h"

namespace rumi {

// Returns F with x_b^T F x_a = 0 for the undistorted pixels x = (u, v, 1) of a point in two views a and b of one
// camera: K^-T [t]x R K^-1 (Hartley and Zisserman, equation 9.2), not normalized. F x_a is the epipolar line in b. F is
// zero if there is no translation.
Eigen::Matrix3d fundamental_matrix(const Camera& camera, const SE3& b_from_a);

// Returns E = [t]x R, for which b^T E a = 0 for the rays a, b (x/z, y/z, 1) of a point in two views (Hartley and
// Zisserman, section 9.6).
Eigen::Matrix3d essential_matrix(const SE3& b_from_a);

// Returns Sampson's distance of two rays (x/z, y/z, 1) from the constraint b^T E a = 0, in units of x and y (Hartley
// and Zisserman, section 11.4.3). It is infinite if the constraint has no gradient, as without a translation.
double sampson_distance(const Eigen::Matrix3d& essential, const Eigen::Vector3d& a, const Eigen::Vector3d& b);

}  // namespace rumi
