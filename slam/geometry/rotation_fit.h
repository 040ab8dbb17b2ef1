// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace rumi {

struct RotationFit {
  Eigen::Matrix3d b_from_a;
  double median_residual_rad = 0;  // between rotated and seen rays: the part that a rotation does not explain
};

// Returns the rotation that turns rays a into rays b (pairs, of any length) with the least sum of absolute angles:
// Kabsch's solution, iteratively reweighted, so that up to a third of wrong pairs hardly matters. Returns nullopt for
// fewer than three pairs.
std::optional<RotationFit> fit_rotation(std::vector<Eigen::Vector3d> a, std::vector<Eigen::Vector3d> b);

}  // namespace rumi
