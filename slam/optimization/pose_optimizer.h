// SPDX-License-Identifier: BSD-3-Clause
// Finds a camera's pose from known landmarks, and from epipolar matches of points that are not landmarks yet, by robust
// Levenberg-Marquardt steps on the reprojection error and on Sampson's distance (Hartley and Zisserman, section
// 11.4.3). Inliers are chosen again after each round. It does not use Ceres, because it runs several times per frame
// (0.1 ms for 300 points).
#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

#include "slam/geometry/camera.h"
#include "slam/geometry/transform.h"

namespace rumi {

struct PointObservation {
  Eigen::Vector3d point;  // position in the submap
  Eigen::Vector2d pixel;  // undistorted
  double sigma_px = 1.0;  // standard deviation of the pixel
  // The error is multiplied by this matrix and divided by sigma_px (slam/features/keypoint_whitening.h).
  Eigen::Matrix2d whitening = Eigen::Matrix2d::Identity();
  double weight = 1.0;  // weight of the squared error; plays no part in choosing inliers
};

// Another view, whose pose is fixed, and the matches with it. A matched point may be anywhere along its ray. So the
// matches determine the rotation and the direction of the motion, but not its length.
struct EpipolarView {
  struct Match {
    Eigen::Vector2d pixel_there, pixel;  // undistorted
    double sigma_px = 1.0;               // standard deviation of each of the two pixels
  };
  SE3 cam_from_submap;
  std::vector<Match> matches;
};

struct PoseOptimizerOptions {
  int rounds = 4;              // rounds, at most: if a round does not change the inliers, the last one follows
  int iterations = 10;         // iterations in each round, at most
  double inlier_chi2 = 5.991;  // largest squared error of an inlier, in sigma^2: 95 % of a 2-D normal distribution
  // Observations with a larger squared error (in sigma^2) at the initial pose are left out of the first round. To be
  // set if the initial pose is known to be close.
  double first_gate_chi2 = std::numeric_limits<double>::infinity();
};

struct PoseResult {
  SE3 cam_from_submap;
  std::vector<bool> inlier;  // by observation
  int inliers = 0;
  double rmse_px = 0;      // root mean square error of the inliers, in units of their sigma
  bool converged = false;  // false: fewer than 6 inliers, or a singular system; then the pose is that of the last round
                           // that was done, or the initial one
};

// The matches of `views` take part in every round and are not counted as inliers. A match whose error is within 95 % of
// a normal distribution has weight 1; beyond that, the weight falls with the fourth power of the error.
PoseResult optimize_pose(const Camera& camera, const SE3& initial_cam_from_submap,
                         const std::vector<PointObservation>& observations, const PoseOptimizerOptions& options = {},
                         const std::vector<EpipolarView>& views = {});

// Returns the information that the matches of a view give about the pose: the inverse covariance of the twist
// (translation, rotation) in exp(twist) * cam_from_submap, with weights as in optimize_pose().
Matrix6d epipolar_information(const Camera& camera, const SE3& cam_from_submap, const EpipolarView& view);

}  // namespace rumi
