// SPDX-License-Identifier: BSD-3-Clause
// Least-squares alignment of point sets (Umeyama, "Least-squares estimation of transformation parameters between two
// point patterns", PAMI 1991).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "slam/geometry/transform.h"

namespace rumi {

// target_from_source minimizing sum |target_i - T source_i|^2; with_scale = false fixes the scale at 1. Nothing for
// fewer than three points, different counts, non-finite input or source points that coincide. Points on one line leave
// a rotation about it undetermined: a valid but arbitrary choice is returned.
std::optional<Sim3> umeyama(const std::vector<Eigen::Vector3d>& source, const std::vector<Eigen::Vector3d>& target,
                            bool with_scale = true);

}  // namespace rumi
