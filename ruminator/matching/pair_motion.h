// SPDX-License-Identifier: BSD-3-Clause
// What the matches of two images say of the camera's motion: does it only turn, or is there depth to be seen? The
// models are compared by the geometric robust information criterion (GRIC: Torr, "Geometric motion segmentation and
// model selection", Phil. Trans. R. Soc. A, 1998): what a model does not explain costs, and what it needs to explain
// it.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "ruminator/matching/sift_matching.h"
#include "slam/geometry/camera.h"

namespace rumi::ruminator {

enum class MotionKind {
  kUnknown,  // too few matches, too many that have nothing to do with each other, or a bit of either
  kStill,    // the pictures are the same
  kTurn,     // a rotation of the camera explains what moved
  kDepth,    // it does not: an essential matrix does, for much that the rotation leaves far out
};

struct PairMotion {
  MotionKind kind = MotionKind::kUnknown;
  int matches = 0;        // of one of the models, that are no outliers
  double sigma_px = 0;    // of a keypoint's position
  double turn_rad = 0;    // by the rotation that explains most
  double turn_cost = 0;   // GRIC of the rotation, by match
  double depth_cost = 0;  // the same of the essential matrix
  double evidence = 0;    // of depth, of all matches: what it costs less; 0 where neither explains them
  double moved = 0;       // part of the matches that it explains that are far from where the rotation has them
};

// `matches`: with outliers, as match_sift returns them; undistorted pixels of either image by its indices.
PairMotion judge_motion(const Camera& camera, const std::vector<Eigen::Vector2f>& first,
                        const std::vector<Eigen::Vector2f>& second, const IndexPairs& matches);

}  // namespace rumi::ruminator
