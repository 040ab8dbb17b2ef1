// SPDX-License-Identifier: BSD-3-Clause
// The motion of the image between two frames, as a rotation of the camera.
#pragma once

#include <Eigen/Core>

#include "slam/features/features.h"
#include "slam/geometry/camera.h"

namespace rumi::front_tracker {

// The largest distance of a keypoint from where it is expected, as a share of the image's width.
inline constexpr double kFarthestMotion = 0.1;

struct FrameMotion {
  Eigen::Matrix3d b_from_a = Eigen::Matrix3d::Identity();
  double radius_px = 0;  // search radius around the rotated keypoints; allows for motion that is not a rotation
};

// Returns the identity and the largest radius if too few keypoints match.
FrameMotion estimate_motion(const Camera& camera, const Features& a, const Features& b);

}  // namespace rumi::front_tracker
