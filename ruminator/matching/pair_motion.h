// SPDX-License-Identifier: BSD-3-Clause
// Decides from the matches of two images whether the camera only turned, or whether they show depth. The models are
// compared by the geometric robust information criterion (GRIC: Torr, "Geometric motion segmentation and model
// selection", Phil. Trans. R. Soc. A, 1998): a model pays for residuals, and for its parameters.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "ruminator/matching/sift_matching.h"
#include "slam/geometry/camera.h"

namespace rumi::ruminator {

enum class MotionKind {
  kUnknown,  // too few matches, too many outliers, or too little difference between the models
  kStill,    // the pictures are the same
  kTurn,     // a rotation of the camera explains what moved
  kDepth,    // a rotation does not: an essential matrix explains many matches that the rotation leaves far out
};

struct PairMotion {
  MotionKind kind = MotionKind::kUnknown;
  int matches = 0;        // inliers of one of the models
  double sigma_px = 0;    // standard deviation of a keypoint's position
  double turn_rad = 0;    // angle of the rotation that explains most
  double turn_cost = 0;   // GRIC of the rotation, per match
  double depth_cost = 0;  // GRIC of the essential matrix, per match
  // How much less the essential matrix costs for all matches: evidence for depth. 0 if neither model explains them.
  double evidence = 0;
  // Share of the matches explained by depth that are far from where the rotation puts them.
  double moved = 0;
};

// `first`, `second`: undistorted pixels of either image. `matches`: their indices, with outliers, as match_sift()
// returns them.
PairMotion judge_motion(const Camera& camera, const std::vector<Eigen::Vector2f>& first,
                        const std::vector<Eigen::Vector2f>& second, const IndexPairs& matches);

}  // namespace rumi::ruminator
