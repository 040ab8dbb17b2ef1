// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace rumi {

struct RotationFit {
  Eigen::Matrix3d b_from_a;
  double median_residual_rad = 0;  // between rotated and seen: what a rotation does not explain
};

// Rotation that turns rays a into rays b (of any length, in pairs), with the least sum of absolute angles: Kabsch's
// solution, iteratively reweighted, so that a third of wrong pairs does little. Nothing for fewer than three pairs.
std::optional<RotationFit> fit_rotation(std::vector<Eigen::Vector3d> a, std::vector<Eigen::Vector3d> b);

}  // namespace rumi
