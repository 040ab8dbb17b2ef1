// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "slam/geometry/transform.h"

namespace rumi {

// Fits second_from_first better to pairs of rays, given as (x/z, y/z). Its translation must have unit length, and keeps
// it. The function takes robust Levenberg-Marquardt steps on Sampson's distance to the epipolar constraint (Hartley and
// Zisserman, section 11.4.3). `sigma` is the standard deviation of a ray's x and y. The pose stays unchanged if no
// better one is found.
void refine_relative_pose(const std::vector<Eigen::Vector2d>& first, const std::vector<Eigen::Vector2d>& second,
                          double sigma, SE3* second_from_first);

}  // namespace rumi
