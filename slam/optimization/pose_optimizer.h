// SPDX-License-Identifier: BSD-3-Clause
// Camera pose from known landmarks, and from epipolar matches of points that are no landmarks yet. Robust Gauss-Newton
// on the reprojection error and on Sampson's distance (Hartley and Zisserman, section 11.4.3); inliers are chosen again
// after each round. It does not use Ceres because it runs several times per frame (0.1 ms for 300 points).
#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

#include "slam/geometry/camera.h"
#include "slam/geometry/transform.h"

namespace rumi {

struct PointObservation {
  Eigen::Vector3d point;  // in the submap
  Eigen::Vector2d pixel;  // undistorted
  double sigma_px = 1.0;  // standard deviation of the pixel
  // The error is multiplied by this and by 1/sigma_px (slam/features/keypoint_whitening.h).
  Eigen::Matrix2d whitening = Eigen::Matrix2d::Identity();
  double weight = 1.0;  // of the squared error; does not decide whether it is an inlier
};

// Another view, whose pose is held, and its matches. A matched point may be anywhere along its ray: it determines the
// rotation and the direction of the motion, but not its length.
struct EpipolarView {
  struct Match {
    Eigen::Vector2d pixel_there, pixel;  // undistorted
    double sigma_px = 1.0;               // standard deviation of either
  };
  SE3 cam_from_submap;
  std::vector<Match> matches;
};

struct PoseOptimizerOptions {
  int rounds = 4;              // inliers are sorted out after each
  int iterations = 10;         // at most, in each round
  double inlier_chi2 = 5.991;  // squared error over sigma^2, 95 % of a 2-D normal distribution
  // Observations with a larger squared error (sigma^2) at the initial pose are left out of the first round. Set it if
  // the initial pose is known to be close.
  double first_gate_chi2 = std::numeric_limits<double>::infinity();
};

struct PoseResult {
  SE3 cam_from_submap;
  std::vector<bool> inlier;  // for each observation
  int inliers = 0;
  double rmse_px = 0;      // of the inliers, in units of their sigma
  bool converged = false;  // false: fewer than 6 inliers or a singular system; the pose is the last good one
};

// The matches of `views` take part in every round. A match has weight 1 within 95 % of a normal distribution; beyond,
// the weight falls with the inverse fourth power. They are not counted as inliers.
PoseResult optimize_pose(const Camera& camera, const SE3& initial_cam_from_submap,
                         const std::vector<PointObservation>& observations, const PoseOptimizerOptions& options = {},
                         const std::vector<EpipolarView>& views = {});

// The information that such a view gives about the pose: inverse covariance of the twist (translation, rotation) in
// exp(twist) * cam_from_submap, with weights as above.
Matrix6d epipolar_information(const Camera& camera, const SE3& cam_from_submap, const EpipolarView& view);

}  // namespace rumi
