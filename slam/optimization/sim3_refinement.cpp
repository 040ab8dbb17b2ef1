// SPDX-License-Identifier: BSD-3-Clause
#include "slam/optimization/sim3_refinement.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

namespace rumi {
namespace {

using Observation = Sim3RefinementProblem::Observation;
using FramePair = Sim3RefinementProblem::FramePair;
using ScaleMeasurement = Sim3RefinementProblem::ScaleMeasurement;
using Matrix37d = Eigen::Matrix<double, 3, 7>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A residual in units of sigma, and its derivative by the step in Sim3::plus(step, pivot).
template <int N>
struct Term {
  Eigen::Matrix<double, N, 1> residual;
  Eigen::Matrix<double, N, 7> jacobian;
  double chi2 = kInfinity;  // infinite if the point is behind the camera; then the other members are not set
};

// Returns the derivative of x by the step of b_from_a. x is the image in B of a point of A, `center` that of the pivot.
Matrix37d image_by_step(const Eigen::Vector3d& x, const Eigen::Vector3d& center) {
  Matrix37d g;
  g << -skew(x - center), Eigen::Matrix3d::Identity(), x - center;
  return g;
}

// `point` is in the submap that has the camera; by_step is its derivative by the step of b_from_a.
Term<2> reproject(const Camera& camera, const Observation& o, const Eigen::Vector3d& point, const Matrix37d& by_step) {
  Term<2> term;
  const Eigen::Vector3d p = o.cam_from_other * point;
  if (!(p.z() > 1e-9)) return term;
  const double iz = 1.0 / p.z(), fx = camera.fx / o.sigma_px, fy = camera.fy / o.sigma_px;
  Eigen::Matrix<double, 2, 3> by_point;
  by_point << fx * iz, 0, -fx * p.x() * iz * iz, 0, fy * iz, -fy * p.y() * iz * iz;
  term.residual = (camera.project_undistorted(p) - o.pixel) / o.sigma_px;
  term.jacobian = by_point * (o.cam_from_other.rotation.toRotationMatrix() * by_step);
  term.chi2 = term.residual.squaredNorm();
  return term;
}

// Residuals and derivatives at one value of b_from_a.
class Linearization {
 public:
  Linearization(const Camera& camera, const Sim3& b_from_a, const Eigen::Vector3d& pivot_a)
      : camera_(camera),
        b_from_a_(b_from_a),
        a_from_b_(b_from_a.inverse()),
        a_by_b_(a_from_b_.scale * a_from_b_.rotation.toRotationMatrix()),
        center_(b_from_a * pivot_a) {}

  Term<2> a_into_b(const Observation& o) const {
    const Eigen::Vector3d point_b = b_from_a_ * o.point;
    return reproject(camera_, o, point_b, image_by_step(point_b, center_));
  }
  // A step of b_from_a moves the image in A of a point of B the opposite way.
  Term<2> b_into_a(const Observation& o) const {
    return reproject(camera_, o, a_from_b_ * o.point, -a_by_b_ * image_by_step(o.point, center_));
  }
  Term<6> frame_pair(const FramePair& f) const {
    Term<6> term;
    const Eigen::Vector3d turn =
        so3_log(f.cam_from_b.rotation * b_from_a_.rotation * f.cam_from_a.rotation.conjugate());
    const Eigen::Vector3d center_b = b_from_a_ * f.cam_from_a.center();
    term.residual << turn / f.sigma_rotation_rad, (center_b - f.cam_from_b.center()) / f.sigma_center;
    term.jacobian.setZero();
    term.jacobian.topLeftCorner<3, 3>() =
        so3_left_jacobian(turn).inverse() * f.cam_from_b.rotation.toRotationMatrix() / f.sigma_rotation_rad;
    term.jacobian.bottomRows<3>() = image_by_step(center_b, center_) / f.sigma_center;
    term.chi2 = term.residual.squaredNorm();
    return term;
  }
  Term<1> scale(const ScaleMeasurement& m) const {
    Term<1> term;
    term.residual(0) = (std::log(b_from_a_.scale) - m.log_scale) / m.sigma;
    term.jacobian.setZero();
    term.jacobian(6) = 1 / m.sigma;
    term.chi2 = term.residual.squaredNorm();
    return term;
  }

 private:
  const Camera& camera_;
  Sim3 b_from_a_, a_from_b_;
  Eigen::Matrix3d a_by_b_;
  Eigen::Vector3d center_;
};

// The terms that take part in a round.
struct Selection {
  std::vector<bool> a_into_b, b_into_a, frame_pairs;
  std::vector<ScaleMeasurement> scales;
};

struct NormalEquations {
  Matrix7d h = Matrix7d::Zero();
  Vector7d g = Vector7d::Zero();
  double cost = 0;

  // Adds a term. If huber_chi2 is infinite, the loss is squared. A point behind the camera makes the cost infinite, so
  // that the step is refused.
  template <int N>
  void add(const Term<N>& term, double huber_chi2) {
    if (std::isinf(term.chi2)) {
      cost = kInfinity;
      return;
    }
    const bool far = term.chi2 > huber_chi2;
    const double w = far ? std::sqrt(huber_chi2 / term.chi2) : 1.0;
    cost += far ? 2 * std::sqrt(huber_chi2 * term.chi2) - huber_chi2 : term.chi2;
    h.noalias() += w * term.jacobian.transpose() * term.jacobian;
    g.noalias() += w * term.jacobian.transpose() * term.residual;
  }
};

// Returns the mean squared length, divided by n, of those n-D standard normal variables (n even) whose squared length
// is below the threshold: inliers that were chosen by a threshold have residuals that are smaller by this factor.
double kept_variance(int n, double threshold) {
  const auto below = [threshold](int degrees) {
    double term = std::exp(-0.5 * threshold), sum = 0;
    for (int j = 0; j < degrees / 2; ++j, term *= 0.5 * threshold / j) sum += term;
    return 1 - sum;
  };
  return below(n + 2) / below(n);
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

class Refiner {
 public:
  Refiner(const Camera& camera, const Sim3RefinementOptions& options, const Sim3RefinementProblem& problem,
          const Sim3& b_from_a)
      : camera_(camera), options_(options), problem_(problem), b_from_a_(b_from_a), pivot_a_(middle()) {}

  // Leaves the report's `reason` empty if the result is usable.
  Sim3RefinementReport run();
  const Sim3& b_from_a() const { return b_from_a_; }

 private:
  Eigen::Vector3d middle() const;
  NormalEquations linearize(const Sim3& b_from_a, const Selection& use, bool robust) const;
  bool minimize(const Selection& use, bool robust, int* iterations);
  Selection near_start() const;
  Selection inliers() const;
  void measure(const Selection& use, Sim3RefinementReport* report) const;
  void measure_covariance(const Selection& use, double chi2_sum, Sim3RefinementReport* report) const;

  const Camera& camera_;
  const Sim3RefinementOptions& options_;
  const Sim3RefinementProblem& problem_;
  Sim3 b_from_a_;
  Eigen::Vector3d pivot_a_;  // in the middle of the observed points: steps about it are well conditioned
};

Eigen::Vector3d Refiner::middle() const {
  std::vector<double> coordinates[3];
  const auto add = [&coordinates](const Eigen::Vector3d& point_a) {
    for (int k = 0; k < 3; ++k) coordinates[k].push_back(point_a[k]);
  };
  const Sim3 a_from_b = b_from_a_.inverse();
  for (const Observation& o : problem_.a_into_b) add(o.point);
  for (const Observation& o : problem_.b_into_a) add(a_from_b * o.point);
  for (const FramePair& f : problem_.frame_pairs) add(f.cam_from_a.center());
  return {median(coordinates[0]), median(coordinates[1]), median(coordinates[2])};
}

NormalEquations Refiner::linearize(const Sim3& b_from_a, const Selection& use, bool robust) const {
  const Linearization at(camera_, b_from_a, pivot_a_);
  const double huber = robust ? options_.inlier_chi2 : kInfinity;
  const double pair_huber = robust ? options_.pair_inlier_chi2 : kInfinity;
  NormalEquations n;
  for (size_t i = 0; i < use.a_into_b.size(); ++i)
    if (use.a_into_b[i]) n.add(at.a_into_b(problem_.a_into_b[i]), huber);
  for (size_t i = 0; i < use.b_into_a.size(); ++i)
    if (use.b_into_a[i]) n.add(at.b_into_a(problem_.b_into_a[i]), huber);
  for (size_t i = 0; i < use.frame_pairs.size(); ++i)
    if (use.frame_pairs[i]) n.add(at.frame_pair(problem_.frame_pairs[i]), pair_huber);
  for (const ScaleMeasurement& m : use.scales) n.add(at.scale(m), kInfinity);
  return n;
}

// Takes Levenberg-Marquardt steps until the cost stalls. Returns false if it does not within the allowed iterations.
bool Refiner::minimize(const Selection& use, bool robust, int* iterations) {
  double lambda = 1e-6;
  NormalEquations n = linearize(b_from_a_, use, robust);
  for (int i = 0; i < options_.iterations; ++i, ++*iterations) {
    Matrix7d h = n.h;
    // A direction without any information (zero on the diagonal) gets a zero step.
    for (int k = 0; k < 7; ++k) h(k, k) += lambda * n.h(k, k) + (n.h(k, k) > 0 ? 0 : 1);
    const Vector7d step = -Eigen::LDLT<Matrix7d>(h).solve(n.g);
    const Sim3 moved = b_from_a_.plus(step, pivot_a_);
    const bool sane = step.allFinite() && moved.is_finite() && moved.scale > 0 && moved.inverse().is_finite();
    const NormalEquations next = sane ? linearize(moved, use, robust) : NormalEquations{{}, {}, kInfinity};
    if (!(next.cost <= n.cost)) {
      lambda = std::max(lambda * 10, 1e-4);
      if (lambda > 1e6) return true;  // no step is an improvement: this is the minimum
      continue;
    }
    const bool stalled = n.cost - next.cost <= 1e-6 * n.cost;
    b_from_a_ = moved;
    n = next;
    lambda = std::max(lambda * 0.1, 1e-9);
    if (stalled) return true;
  }
  return false;
}

// Selects the terms of the first round. Observations that are far off at the start are left out: they are outliers, or
// points nearly in the camera's plane, which would dominate.
Selection Refiner::near_start() const {
  const Linearization at(camera_, b_from_a_, pivot_a_);
  const auto near = [this](double chi2, double sigma_px) {
    return std::sqrt(chi2) * sigma_px <= options_.first_gate_px;
  };
  Selection s;
  for (const Observation& o : problem_.a_into_b) s.a_into_b.push_back(near(at.a_into_b(o).chi2, o.sigma_px));
  for (const Observation& o : problem_.b_into_a) s.b_into_a.push_back(near(at.b_into_a(o).chi2, o.sigma_px));
  s.frame_pairs.assign(problem_.frame_pairs.size(), true);
  s.scales = problem_.scales;
  return s;
}

Selection Refiner::inliers() const {
  const Linearization at(camera_, b_from_a_, pivot_a_);
  Selection s;
  for (const Observation& o : problem_.a_into_b) s.a_into_b.push_back(at.a_into_b(o).chi2 <= options_.inlier_chi2);
  for (const Observation& o : problem_.b_into_a) s.b_into_a.push_back(at.b_into_a(o).chi2 <= options_.inlier_chi2);
  for (const FramePair& f : problem_.frame_pairs)
    s.frame_pairs.push_back(at.frame_pair(f).chi2 <= options_.pair_inlier_chi2);
  s.scales = problem_.scales;
  return s;
}

int count(const std::vector<bool>& v) { return static_cast<int>(std::count(v.begin(), v.end(), true)); }

int equations(const Selection& s) { return 2 * (count(s.a_into_b) + count(s.b_into_a)) + 6 * count(s.frame_pairs); }

void Refiner::measure(const Selection& use, Sim3RefinementReport* report) const {
  report->a_into_b_inlier = use.a_into_b;
  report->b_into_a_inlier = use.b_into_a;
  report->frame_pair_inlier = use.frame_pairs;
  report->inliers = count(use.a_into_b) + count(use.b_into_a);
  const size_t observations = use.a_into_b.size() + use.b_into_a.size();
  if (observations > 0) report->inlier_ratio = report->inliers / static_cast<double>(observations);

  const Linearization at(camera_, b_from_a_, pivot_a_);
  double chi2_sum = 0, squared_px = 0;
  const auto add = [&](double chi2, double sigma_px) {
    chi2_sum += chi2;
    squared_px += chi2 * sigma_px * sigma_px;
  };
  for (size_t i = 0; i < use.a_into_b.size(); ++i)
    if (use.a_into_b[i]) add(at.a_into_b(problem_.a_into_b[i]).chi2, problem_.a_into_b[i].sigma_px);
  for (size_t i = 0; i < use.b_into_a.size(); ++i)
    if (use.b_into_a[i]) add(at.b_into_a(problem_.b_into_a[i]).chi2, problem_.b_into_a[i].sigma_px);
  for (size_t i = 0; i < use.frame_pairs.size(); ++i)
    if (use.frame_pairs[i]) chi2_sum += at.frame_pair(problem_.frame_pairs[i]).chi2;
  if (report->inliers > 0) report->rmse_px = std::sqrt(squared_px / report->inliers);
  measure_covariance(use, chi2_sum, report);
}

// Inverts an information matrix. Directions without information get a large but finite variance. The matrix is scaled
// to a unit diagonal first, so that its eigenvalues are comparable whatever the units.
Matrix7d inverse_or_huge(const Matrix7d& information) {
  constexpr double kNoInformation = 1e-12, kSmallestEigenvalue = 1e-13;
  const Vector7d d = (information.diagonal().array().max(0) + kNoInformation).sqrt().inverse();
  const Eigen::SelfAdjointEigenSolver<Matrix7d> eigen(d.asDiagonal() * information * d.asDiagonal());
  const Vector7d variance = eigen.eigenvalues().cwiseMax(kSmallestEigenvalue).cwiseInverse();
  const Matrix7d v = d.asDiagonal() * eigen.eigenvectors();
  return v * variance.asDiagonal() * v.transpose();
}

// Returns the point, relative to the pivot and in B, at which the trace of the displacement's covariance `c` is least.
// With the step's translation t, rotation w and log scale s, a point at v moves by t + w x v + s v, whose mean square
// is quadratic in v.
Eigen::Vector3d best_known(const Matrix7d& c) {
  const Eigen::Matrix3d ww = c.topLeftCorner<3, 3>(), tw = c.block<3, 3>(3, 0);
  const Eigen::Matrix3d quadratic = (c(6, 6) + ww.trace()) * Eigen::Matrix3d::Identity() - ww;
  const Eigen::Vector3d t_cross_w(tw(1, 2) - tw(2, 1), tw(2, 0) - tw(0, 2), tw(0, 1) - tw(1, 0));
  const Eigen::Vector3d linear = t_cross_w + c.block<3, 1>(3, 6);
  return -quadratic.ldlt().solve(linear);
}

double worst_sigma(const Eigen::Matrix3d& block) {
  return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(block, Eigen::EigenvaluesOnly).eigenvalues()[2]);
}

void Refiner::measure_covariance(const Selection& use, double chi2_sum, Sim3RefinementReport* report) const {
  Selection observations, pairs, scales;
  observations.a_into_b = use.a_into_b;
  observations.b_into_a = use.b_into_a;
  pairs.frame_pairs = use.frame_pairs;
  scales.scales = use.scales;
  // Choosing inliers by a threshold loses information, so their information counts only by the factor `kept`
  // (asymptotic variance of the skipped mean, e.g. Huber, Robust Statistics, 1981, ch. 4.8).
  const double kept = kept_variance(2, options_.inlier_chi2), pair_kept = kept_variance(6, options_.pair_inlier_chi2);
  const double expected_chi2 = kept * equations(observations) + pair_kept * equations(pairs) - 7;
  const double variance = expected_chi2 > 0 ? std::max(1.0, chi2_sum / expected_chi2) : 1.0;
  const Matrix7d of_inliers =
      kept * linearize(b_from_a_, observations, false).h + pair_kept * linearize(b_from_a_, pairs, false).h;
  const Matrix7d at_middle = inverse_or_huge(of_inliers / variance + linearize(b_from_a_, scales, false).h);

  const Eigen::Vector3d v = best_known(at_middle);
  Matrix7d shift = Matrix7d::Identity();
  if (v.allFinite()) {
    shift.block<3, 7>(3, 0) = image_by_step(v, Eigen::Vector3d::Zero());
    report->pivot_a = b_from_a_.inverse() * (b_from_a_ * pivot_a_ + v);
  } else {
    report->pivot_a = pivot_a_;
  }
  report->covariance = shift * at_middle * shift.transpose();
  report->sigma_rotation_rad = worst_sigma(report->covariance.topLeftCorner<3, 3>());
  report->sigma_translation = worst_sigma(report->covariance.block<3, 3>(3, 3));
  report->sigma_log_scale = std::sqrt(report->covariance(6, 6));
  for (double* sigma : {&report->sigma_rotation_rad, &report->sigma_log_scale})
    if (!(*sigma <= options_.max_sigma)) *sigma = kInfinity;
}

Sim3RefinementReport Refiner::run() {
  Sim3RefinementReport report;
  Selection use = near_start();
  bool converged = false;
  for (int round = 0; round < options_.rounds; ++round) {
    if (equations(use) < options_.min_equations) break;
    converged = minimize(use, round + 1 < options_.rounds, &report.iterations);
    use = inliers();
  }
  measure(use, &report);
  if (equations(use) < options_.min_equations)
    report.reason = "too few inliers: " + std::to_string(report.inliers) + " observations and " +
                    std::to_string(count(use.frame_pairs)) + " frame pairs";
  else if (std::isinf(report.sigma_rotation_rad))
    report.reason = "rotation is not determined by the matches";
  else if (std::isinf(report.sigma_log_scale))
    report.reason = "scale is not determined by the matches";
  else if (!converged)
    report.reason = "not converged in " + std::to_string(options_.iterations) + " iterations";
  return report;
}

std::string check(const std::vector<Observation>& observations, const std::string& name) {
  for (size_t i = 0; i < observations.size(); ++i) {
    const Observation& o = observations[i];
    if (!o.point.allFinite() || !o.pixel.allFinite() || !o.cam_from_other.is_finite())
      return name + "[" + std::to_string(i) + "] is not finite";
    if (!(o.sigma_px > 0 && std::isfinite(o.sigma_px))) return name + "[" + std::to_string(i) + "]: sigma_px <= 0";
  }
  return {};
}

std::string check(const Sim3RefinementProblem& problem, const Sim3& b_from_a) {
  if (!b_from_a.is_finite() || !(b_from_a.scale > 0)) return "the initial similarity is not finite";
  if (std::string wrong = check(problem.a_into_b, "a_into_b"); !wrong.empty()) return wrong;
  if (std::string wrong = check(problem.b_into_a, "b_into_a"); !wrong.empty()) return wrong;
  for (size_t i = 0; i < problem.frame_pairs.size(); ++i) {
    const FramePair& f = problem.frame_pairs[i];
    const std::string name = "frame_pairs[" + std::to_string(i) + "]";
    if (!f.cam_from_a.is_finite() || !f.cam_from_b.is_finite()) return name + " is not finite";
    if (!(f.sigma_rotation_rad > 0 && f.sigma_center > 0)) return name + ": sigma <= 0";
  }
  for (size_t i = 0; i < problem.scales.size(); ++i) {
    const ScaleMeasurement& m = problem.scales[i];
    if (!std::isfinite(m.log_scale) || !(m.sigma > 0)) return "scales[" + std::to_string(i) + "] is no measurement";
  }
  return {};
}

}  // namespace

Sim3RefinementReport refine_sim3(const Camera& camera, const Sim3RefinementOptions& options,
                                 const Sim3RefinementProblem& problem, Sim3* b_from_a) {
  Sim3RefinementReport report;
  report.reason = check(problem, *b_from_a);
  if (!report.reason.empty()) return report;
  Refiner refiner(camera, options, problem, *b_from_a);
  report = refiner.run();
  report.usable = report.reason.empty();
  if (report.usable) *b_from_a = refiner.b_from_a();
  return report;
}

}  // namespace rumi
