// SPDX-License-Identifier: BSD-3-Clause
// Decides from the matches of two images whether the camera only rotated, or whether they show depth. The two models
// are compared by the geometric robust information criterion (GRIC: Torr, "Geometric motion segmentation and model
// selection", Phil. Trans. R. Soc. A, 1998), which charges a model for its residuals and for its parameters.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "ruminator/matching/sift_matching.h"
#include "slam/geometry/camera.h"

namespace rumi::ruminator {

enum class MotionKind {
  kUnknown,  // too few matches, too many outliers, or too little difference between the models
  kStill,    // the images are the same
  kTurn,     // a rotation of the camera explains the motion
  kDepth,    // an essential matrix explains many matches that a rotation leaves far off
};

struct PairMotion {
  MotionKind kind = MotionKind::kUnknown;
  int matches = 0;        // inliers of the model with the lower cost
  double sigma_px = 0;    // standard deviation of a keypoint's position
  double turn_rad = 0;    // angle of the rotation that explains most matches
  double turn_cost = 0;   // GRIC of the rotation, per match
  double depth_cost = 0;  // GRIC of the essential matrix, per match
  // By how much the essential matrix costs less, summed over all matches: evidence for depth. 0 if neither model
  // explains them.
  double evidence = 0;
  // Share of the matches explained by the essential matrix that are far from where the rotation puts them.
  double moved = 0;
};

// `first`, `second`: undistorted pixels of the two images. `matches`: their indices, outliers included, as match_sift()
// returns them.
PairMotion judge_motion(const Camera& camera, const std::vector<Eigen::Vector2f>& first,
                        const std::vector<Eigen::Vector2f>& second, const IndexPairs& matches);

}  // namespace rumi::ruminator
