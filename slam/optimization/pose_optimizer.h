// SPDX-License-Identifier: BSD-3-Clause
// Camera pose from known landmarks, and from what other views see of points that are none yet: Gauss-Newton on the
// reprojection error and on Sampson's distance (Hartley and Zisserman, section 11.4.3), robust, re-sorting inliers and
// outliers between rounds. Written out rather than given to Ceres because it runs several times per frame (0.1 ms for
// 300 points).
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
  // What the error is multiplied by besides 1/sigma_px (slam/features/keypoint_whitening.h).
  Eigen::Matrix2d whitening = Eigen::Matrix2d::Identity();
  double weight = 1.0;  // of its squared error; whether it is an inlier does not depend on it
};

// Another view, whose pose is held, and what both see. Such a point may be anywhere along its ray: it tells of the
// rotation and of the direction of the motion, but nothing of its length.
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
  int iterations = 10;         // at most, per round
  double inlier_chi2 = 5.991;  // squared error over sigma^2, 95 % of a 2-D normal distribution
  // Left out of the first round if the initial pose is off by more than this, sigma^2: for initial poses known to be
  // close.
  double first_gate_chi2 = std::numeric_limits<double>::infinity();
};

struct PoseResult {
  SE3 cam_from_submap;
  std::vector<bool> inlier;  // per observation
  int inliers = 0;
  double rmse_px = 0;      // of the inliers, in units of their sigma
  bool converged = false;  // false: fewer than 6 inliers or a singular system; the pose is the last good one
};

// `views` count in every round, each match less the farther it is off: 1 within 95 % of a normal distribution, then
// with the inverse fourth power. They are no inliers.
PoseResult optimize_pose(const Camera& camera, const SE3& initial_cam_from_submap,
                         const std::vector<PointObservation>& observations, const PoseOptimizerOptions& options = {},
                         const std::vector<EpipolarView>& views = {});

// What such a view tells of the pose: inverse covariance of the twist (translation, rotation) in
// exp(twist) * cam_from_submap, every match counting as above.
Matrix6d epipolar_information(const Camera& camera, const SE3& cam_from_submap, const EpipolarView& view);

}  // namespace rumi
