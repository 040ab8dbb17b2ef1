// SPDX-License-Identifier: BSD-3-Clause
// Bundle adjustment: camera poses and points that minimize the reprojection error (Huber loss). Indices, not maps, so
// that a snapshot of part of a submap can be solved while the submap itself goes on changing.
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <memory>
#include <vector>

#include "slam/geometry/camera.h"
#include "slam/geometry/transform.h"

namespace rumi {

struct BundleProblem {
  struct View {
    SE3 cam_from_submap;
    bool fixed = false;
  };
  struct Observation {
    int view = 0;
    int point = 0;
    Eigen::Vector2d pixel;  // undistorted
    double sigma_px = 1.0;
    // What the error is multiplied by besides 1/sigma_px (slam/features/keypoint_whitening.h).
    Eigen::Matrix2d whitening = Eigen::Matrix2d::Identity();
  };
  std::vector<View> views;
  std::vector<Eigen::Vector3d> points;
  std::vector<Observation> observations;
};

struct BundleOptions {
  int iterations = 5;
  double huber_chi2 = 5.991;                  // where the loss turns from squared to linear, in sigma^2
  double function_tolerance = 1e-4;           // ends when the cost falls by less, relatively
  const std::atomic<bool>* cancel = nullptr;  // true ends the iterations
};

struct BundleReport {
  bool usable = false;  // false: nothing to solve, or a point is behind a camera that sees it; the problem is unchanged
  int iterations = 0;
  double initial_cost = 0, final_cost = 0;
};

class ReducedSolver;

// Solves problems one after another. Where they are of the same views and differ little, the later ones cost less.
class BundleSolver {
 public:
  BundleSolver();
  ~BundleSolver();
  // At least one view should be fixed, or two where the scale shall not drift.
  BundleReport solve(const Camera& camera, const BundleOptions& options, BundleProblem* problem);

 private:
  std::unique_ptr<ReducedSolver> solver_;
};

// One problem.
BundleReport solve_bundle(const Camera& camera, const BundleOptions& options, BundleProblem* problem);

// Squared reprojection error of an observation in units of sigma^2; infinite behind the camera.
double reprojection_chi2(const Camera& camera, const BundleProblem& problem, const BundleProblem::Observation& o);

}  // namespace rumi
