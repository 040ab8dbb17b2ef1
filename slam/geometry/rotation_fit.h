// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

namespace rumi {

struct RotationFit {
  Eigen::Matrix3d b_from_a;
  double median_residual_rad = 0;  // median angle between a rotated ray and its partner
};

// Returns the rotation that turns the rays a into the rays b (pairs; any lengths) with the least sum of absolute
// angles. It is Kabsch's solution, iteratively reweighted, so that up to a third of wrong pairs hardly change it.
// Returns nullopt for fewer than three pairs, different counts, or rays that are not finite.
std::optional<RotationFit> fit_rotation(std::vector<Eigen::Vector3d> a, std::vector<Eigen::Vector3d> b);

// Returns the rotation whose angles to the others have the least sum. Precondition: at least one rotation.
Eigen::Quaterniond central_rotation(const std::vector<Eigen::Quaterniond>& rotations);

}  // namespace rumi
