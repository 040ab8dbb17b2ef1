// SPDX-License-Identifier: BSD-3-Clause
// Bundle adjustment: finds the camera poses and points that minimize the reprojection error (Huber loss). The problem
// is a copy with indices, so that part of a submap can be solved while the submap itself goes on changing.
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
    // The error is multiplied by this matrix and divided by sigma_px (slam/features/keypoint_whitening.h).
    Eigen::Matrix2d whitening = Eigen::Matrix2d::Identity();
  };
  std::vector<View> views;
  std::vector<Eigen::Vector3d> points;
  std::vector<Observation> observations;
};

struct BundleOptions {
  int iterations = 5;
  double huber_chi2 = 5.991;                  // squared error in sigma^2 beyond which the loss is linear
  double function_tolerance = 1e-4;           // the iterations end when the cost changes by a smaller part of itself
  const std::atomic<bool>* cancel = nullptr;  // if not null, true ends the iterations
};

struct BundleReport {
  bool usable = false;  // false: no view that observes a point is free, or a point is behind a camera that observes it;
                        // the problem is unchanged
  int iterations = 0;
  double initial_cost = 0, final_cost = 0;
};

class ReducedSolver;

// Solves problems one after another. If a problem has the same views as the one before and differs little, it costs
// less.
class BundleSolver {
 public:
  BundleSolver();
  ~BundleSolver();
  // At least one view should be fixed. Two fixed views also keep the scale. `used`: for each observation, whether it
  // counts; empty: all do.
  BundleReport solve(const Camera& camera, const BundleOptions& options, BundleProblem* problem,
                     const std::vector<char>& used = {});

 private:
  std::unique_ptr<ReducedSolver> solver_;
};

// Solves one problem.
BundleReport solve_bundle(const Camera& camera, const BundleOptions& options, BundleProblem* problem);

// Returns the squared reprojection error of an observation in units of sigma^2; infinite if the point is behind the
// camera.
double reprojection_chi2(const Camera& camera, const BundleProblem& problem, const BundleProblem::Observation& o);

}  // namespace rumi
