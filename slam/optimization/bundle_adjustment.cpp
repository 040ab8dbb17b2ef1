// SPDX-License-Identifier: BSD-3-Clause
#include "slam/optimization/bundle_adjustment.h"

#include <algorithm>
#include <limits>

#include "slam/optimization/dense_bundle.h"
#include "slam/optimization/sparse_bundle.h"

namespace rumi {
namespace {

// Of all pairs of views, the share that see a point in common.
double covisible_share(const BundleProblem& problem) {
  std::vector<std::vector<int>> views_of(problem.points.size());
  for (const BundleProblem::Observation& o : problem.observations) views_of[o.point].push_back(o.view);
  const size_t n = problem.views.size();
  std::vector<char> covisible(n * n, 0);
  for (const std::vector<int>& views : views_of)
    for (int a : views)
      for (int b : views) covisible[a * n + b] = 1;
  return static_cast<double>(std::count(covisible.begin(), covisible.end(), 1)) / static_cast<double>(n * n);
}

// In a room nearly every view shares points with every other one: dense is 1.5 times as fast with 70, 175 and 295
// views. Where only neighbours do (an eighth of the pairs), it costs a quarter more with 250.
bool suits_dense(const BundleProblem& problem) {
  constexpr size_t kSmall = 200, kLarge = 500;  // 500 views: a matrix of 72 MB
  const size_t views = problem.views.size();
  return views <= kSmall || (views <= kLarge && covisible_share(problem) > 1.0 / 3);
}

}  // namespace

BundleReport solve_bundle(const Camera& camera, const BundleOptions& options, BundleProblem* problem) {
  return suits_dense(*problem) ? solve_dense_bundle(camera, options, problem)
                               : solve_sparse_bundle(camera, options, problem);
}

double reprojection_chi2(const Camera& camera, const BundleProblem& problem, const BundleProblem::Observation& o) {
  const Eigen::Vector3d p = problem.views[o.view].cam_from_submap * problem.points[o.point];
  if (!(p.z() > 1e-9)) return std::numeric_limits<double>::infinity();
  return (o.whitening * (camera.project_undistorted(p) - o.pixel)).squaredNorm() / (o.sigma_px * o.sigma_px);
}

}  // namespace rumi
