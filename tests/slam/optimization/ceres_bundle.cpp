// SPDX-License-Identifier: BSD-3-Clause
#include "tests/slam/optimization/ceres_bundle.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "slam/optimization/whitened_projection.h"

namespace rumi {
namespace {

// A pose as 7 numbers (x y z w of the quaternion, translation) that moves by exp(twist) on the left. The Jacobians of
// cost functions have the derivative by the twist in their first six columns, and zeros in the seventh: that saves a
// product per residual.
class PoseManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 7; }
  int TangentSize() const override { return 6; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    const SE3 moved = SE3::exp(Eigen::Map<const Vector6d>(delta)) * read(x);
    write(moved, x_plus_delta);
    return true;
  }
  bool PlusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 7, 6, Eigen::RowMajor>> j(jacobian);
    j.setZero();
    j.topRows<6>().setIdentity();
    return true;
  }
  bool Minus(const double* y, const double* x, double* y_minus_x) const override {
    Eigen::Map<Vector6d>{y_minus_x} = (read(y) * read(x).inverse()).log();
    return true;
  }
  bool MinusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>> j(jacobian);
    j.setZero();
    j.leftCols<6>().setIdentity();
    return true;
  }
  static SE3 read(const double* x) {
    return {Eigen::Quaterniond(x[3], x[0], x[1], x[2]), Eigen::Vector3d(x[4], x[5], x[6])};
  }
  static void write(const SE3& pose, double* x) {
    Eigen::Map<Eigen::Vector4d>{x} = pose.rotation.coeffs();
    Eigen::Map<Eigen::Vector3d>{x + 4} = pose.translation;
  }
};

class ReprojectionError final : public ceres::SizedCostFunction<2, 7, 3> {
 public:
  explicit ReprojectionError(const WhitenedProjection& projection) : projection_(projection) {}

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const double* x = parameters[0];
    const Eigen::Matrix3d r = Eigen::Quaterniond(x[3], x[0], x[1], x[2]).toRotationMatrix();
    const Eigen::Vector3d p =
        r * Eigen::Map<const Eigen::Vector3d>(parameters[1]) + Eigen::Map<const Eigen::Vector3d>(x + 4);
    // An intermediate step has put the point behind the camera: Ceres refuses the step.
    if (!(p.z() > 1e-9)) return false;
    Eigen::Map<Eigen::Vector2d>{residuals} = projection_.error(p);
    if (!jacobians) return true;
    const Eigen::Matrix<double, 2, 3> by_p = projection_.derivative(p);
    if (jacobians[0]) {
      Eigen::Map<Eigen::Matrix<double, 2, 7, Eigen::RowMajor>> j(jacobians[0]);
      j << by_p, -by_p * skew(p), Eigen::Vector2d::Zero();
    }
    if (jacobians[1]) Eigen::Map<Eigen::Matrix<double, 2, 3, Eigen::RowMajor>>{jacobians[1]} = by_p * r;
    return true;
  }

 private:
  WhitenedProjection projection_;
};

ceres::Solver::Options solver_options(const BundleOptions& options) {
  ceres::Solver::Options o;
  o.linear_solver_type = ceres::SPARSE_SCHUR;
  o.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
  o.max_num_iterations = options.iterations;
  o.num_threads = 1;  // so that results are the same to the bit
  o.function_tolerance = options.function_tolerance;
  o.logging_type = ceres::SILENT;
  return o;
}

}  // namespace

BundleReport solve_by_ceres(const Camera& camera, const BundleOptions& options, BundleProblem* problem) {
  BundleReport report;
  if (problem->observations.empty()) return report;
  std::vector<std::array<double, 7>> poses(problem->views.size());
  for (size_t i = 0; i < poses.size(); ++i) PoseManifold::write(problem->views[i].cam_from_submap, poses[i].data());
  std::vector<Eigen::Vector3d> points = problem->points;

  PoseManifold manifold;
  ceres::HuberLoss loss(std::sqrt(options.huber_chi2));
  ceres::Problem::Options ownership;
  ownership.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ownership.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ownership.disable_all_safety_checks = true;  // they look for blocks that are given twice, with a hash look-up for
                                               // each block
  ceres::Problem ceres_problem(ownership);
  auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  std::vector<char> seen(poses.size(), 0);
  for (const BundleProblem::Observation& o : problem->observations) {
    ceres_problem.AddResidualBlock(new ReprojectionError({camera, o.pixel, o.sigma_px, o.whitening}), &loss,
                                   poses[o.view].data(), points[o.point].data());
    ordering->AddElementToGroup(points[o.point].data(), 0);
    if (!seen[o.view]) ordering->AddElementToGroup(poses[o.view].data(), 1);
    seen[o.view] = 1;
  }
  bool any_free = false;
  for (size_t i = 0; i < poses.size(); ++i) {
    if (!seen[i]) continue;
    ceres_problem.SetManifold(poses[i].data(), &manifold);
    if (problem->views[i].fixed) ceres_problem.SetParameterBlockConstant(poses[i].data());
    any_free = any_free || !problem->views[i].fixed;
  }
  if (!any_free) return report;

  ceres::Solver::Options o = solver_options(options);
  o.linear_solver_ordering = ordering;
  ceres::Solver::Summary summary;
  ceres::Solve(o, &ceres_problem, &summary);
  report.iterations = static_cast<int>(summary.iterations.size());
  report.initial_cost = summary.initial_cost;
  report.final_cost = summary.final_cost;
  report.usable = summary.IsSolutionUsable();
  if (!report.usable) return report;
  for (size_t i = 0; i < poses.size(); ++i)
    if (seen[i] && !problem->views[i].fixed) problem->views[i].cam_from_submap = PoseManifold::read(poses[i].data());
  problem->points = std::move(points);
  return report;
}

}  // namespace rumi
