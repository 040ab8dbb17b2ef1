// SPDX-License-Identifier: BSD-3-Clause
// Least-squares alignment of point sets (Umeyama, "Least-squares estimation of transformation parameters between two
// point patterns", PAMI 1991).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "slam/geometry/transform.h"

namespace rumi {

// Returns target_from_source, which minimizes sum |target_i - T source_i|^2; its scale is 1 if with_scale is false.
// Returns nullopt for fewer than three points, different counts, values that are not finite, source points that
// coincide, or, if with_scale is true, target points that coincide. If the points lie on one line, the rotation about
// it is not determined: one of the valid rotations is returned.
std::optional<Sim3> umeyama(const std::vector<Eigen::Vector3d>& source, const std::vector<Eigen::Vector3d>& target,
                            bool with_scale = true);

}  // namespace rumi
