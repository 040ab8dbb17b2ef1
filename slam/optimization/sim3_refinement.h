// SPDX-License-Identifier: BSD-3-Clause
// Finds the similarity that joins two submaps, from landmarks of each that are seen in frames of the other. It
// minimizes the reprojection error in both directions (Chen et al., "Rumination Meets VSLAM", 2023, eq. 8, has one
// direction), is robust, and returns the covariance. It does not use Ceres: there are seven unknowns, and the
// covariance needs the normal equations anyway.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "slam/geometry/camera.h"
#include "slam/geometry/transform.h"

namespace rumi {

using Matrix7d = Eigen::Matrix<double, 7, 7>;

struct Sim3RefinementProblem {
  // A landmark of one submap that is seen in a frame of the other. The landmark's position counts as exact: its error,
  // which all its observations share, does not average out and is not part of the covariance.
  struct Observation {
    Eigen::Vector3d point;  // position in the landmark's own submap
    SE3 cam_from_other;     // pose of the frame in the other submap
    Eigen::Vector2d pixel;  // undistorted
    double sigma_px = 1.0;
  };
  // An image that has a pose in both submaps.
  struct FramePair {
    SE3 cam_from_a, cam_from_b;
    double sigma_rotation_rad = 0.01;  // deviation of each component of the rotation vector between the poses
    double sigma_center = 0.1;         // deviation of each coordinate of the difference of the centres, in the unit of
                                       // B
  };
  // A measurement of the scale of b_from_a by other means, such as the depths of common landmarks. If the cameras of
  // the observations hardly move, the reprojection error does not determine the scale.
  struct ScaleMeasurement {
    double log_scale = 0;
    double sigma = 0.01;
  };
  std::vector<Observation> a_into_b;  // points of A, frames of B: cam_from_other * (b_from_a * point)
  std::vector<Observation> b_into_a;  // points of B, frames of A: cam_from_other * (b_from_a^-1 * point)
  std::vector<FramePair> frame_pairs;
  std::vector<ScaleMeasurement> scales;  // all of them count; none can be an outlier
};

struct Sim3RefinementOptions {
  int rounds = 3;                    // outliers are removed after each round; all rounds but the last use the Huber
                                     // loss
  int iterations = 30;               // per round, at most
  double first_gate_px = 200;        // observations with a larger error at the initial similarity are left out of the
                                     // first round
  double inlier_chi2 = 5.991;        // largest squared error of an inlier, in sigma^2: 95 % of a 2-D normal
                                     // distribution
  double pair_inlier_chi2 = 12.592;  // as inlier_chi2 for a frame pair, 6-D
  int min_equations = 14;            // equations of the inliers, at least: 2 per observation, 6 per frame pair; there
                                     // are 7 unknowns
  // Rotation (rad) and log scale are undetermined if their standard deviation is larger. If there is no parallax, the
  // best scale only explains noise: its sigma is about 1, and seldom below 0.3.
  double max_sigma = 0.2;
};

struct Sim3RefinementReport {
  bool usable = false;  // false: *b_from_a is unchanged, and `reason` says why
  std::string reason;
  int iterations = 0;
  std::vector<bool> a_into_b_inlier, b_into_a_inlier, frame_pair_inlier;
  int inliers = 0;          // observations in both directions, without frame pairs
  double inlier_ratio = 0;  // inliers / all observations; 0 if there are none
  double rmse_px = 0;       // root mean square error of the inlying observations (both coordinates together)

  // The covariance of the step with which b_from_a.plus(step, pivot_a) would be true: rotation vector (rad),
  // displacement of the pivot (unit of B), log scale. It is the inverse of the inliers' information, widened if their
  // residuals are larger than their sigmas promise. The pivot is the point of A whose displacement is known best, which
  // decouples it from rotation and scale as far as possible; the origin of A may be far from the overlap. Directions
  // that are not determined have huge, finite entries.
  Eigen::Vector3d pivot_a = Eigen::Vector3d::Zero();
  Matrix7d covariance = Matrix7d::Zero();
  // The standard deviations in the worst direction: square roots of the blocks' largest eigenvalues. Infinite if
  // rotation or scale is undetermined.
  double sigma_rotation_rad = 0, sigma_translation = 0, sigma_log_scale = 0;
};

Sim3RefinementReport refine_sim3(const Camera& camera, const Sim3RefinementOptions& options,
                                 const Sim3RefinementProblem& problem, Sim3* b_from_a);

}  // namespace rumi
