// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "slam/optimization/pose_optimizer.h"

namespace rumi {

struct ResectionOptions {
  int min_inliers = 12;
  double max_error_px = 4.0;
  int iterations = 200;  // iterations of RANSAC, at most
};

// Returns the camera's pose from observations of points, many of which may be wrong: P3P in RANSAC, then
// optimize_pose(). Returns nullopt if fewer than min_inliers agree. Deterministic.
std::optional<PoseResult> resect(const Camera& camera, const std::vector<PointObservation>& observations,
                                 const ResectionOptions& options = {});

}  // namespace rumi
