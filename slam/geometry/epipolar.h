// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "slam/geometry/camera.h"
#include "slam/geometry/transform.h"

namespace rumi {

// F with x_b^T F x_a = 0 for the undistorted pixels x = (u, v, 1) of a point in two views a and b of one camera:
// K^-T [t]x R K^-1 (Hartley and Zisserman, equation 9.2), not normalized. F x_a is the epipolar line in b. Zero
// without a translation.
Eigen::Matrix3d fundamental_matrix(const Camera& camera, const SE3& b_from_a);

}  // namespace rumi
