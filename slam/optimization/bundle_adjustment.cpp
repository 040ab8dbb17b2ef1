// SPDX-License-Identifier: BSD-3-Clause
#include "slam/optimization/bundle_adjustment.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "slam/optimization/block_matrix.h"
#include "slam/optimization/reduced_solver.h"
#include "slam/optimization/whitened_projection.h"

namespace rumi {
namespace {

using Matrix63d = Eigen::Matrix<double, 6, 3>;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
// The least value of the diagonal when it is damped: an unknown that nothing determines stays where it is.
constexpr double kMinDiagonal = 1e-6;

// The damping is the diagonal divided by the radius of a trust region (Madsen et al., "Methods for Non-Linear Least
// Squares Problems", 2004, eq. 2.21).
class TrustRegion {
 public:
  double damping() const { return 1 / radius_; }
  void accept(double gain) {
    radius_ = std::min(1e16, radius_ / std::max(1.0 / 3, 1 - std::pow(2 * gain - 1, 3)));
    shrink_by_ = 2;
  }
  void refuse() { radius_ /= std::exchange(shrink_by_, 2 * shrink_by_); }

 private:
  double radius_ = 1e4, shrink_by_ = 2;
};

struct View {
  SE3 cam_from_submap;
  Eigen::Matrix3d rotation;
};

struct State {
  std::vector<View> views;
  std::vector<Eigen::Vector3d> points;
};

// Huber's loss (1964) of a squared error s, linear beyond `chi2`, and the weight that it gives to the error.
struct Huber {
  double chi2;
  double rho(double s) const { return s <= chi2 ? s : 2 * std::sqrt(chi2 * s) - chi2; }
  double weight(double s) const { return s <= chi2 ? 1 : std::sqrt(chi2 / s); }
};

class NormalEquations {
 public:
  NormalEquations(const Camera& camera, const BundleOptions& options, const BundleProblem& problem,
                  const std::vector<char>& used);
  bool has_free_views() const { return !free_.empty(); }
  // Returns half the sum of the robust squared errors; infinite if a point is behind a camera that observes it.
  double cost(const State& state) const;
  // Computes the normal equations at the state.
  void linearize(const State& state);
  // Returns the state after the step that solves the damped normal equations; *predicted is the decrease of the cost
  // that it promises. Returns nullopt if they cannot be solved.
  std::optional<State> step(const State& from, double damping, ReducedSolver* solver, double* predicted);

 private:
  struct Observation {
    int view = 0, point = 0;
    WhitenedProjection projection;
  };
  struct Point {
    int begin = 0, end = 0;  // range of its observations in observations_
    Eigen::Matrix3d hessian;
    Eigen::Vector3d gradient;
    Eigen::Matrix3d inverse;  // inverse of the damped hessian
  };
  struct Unknown {  // a view that is not fixed
    int view;
    Matrix6d hessian;
    Vector6d gradient;
  };

  std::vector<std::vector<int>> pattern() const;
  // Derivatives of the cost of an observation, of which those by its point and by its view are made.
  struct Derivatives {
    Eigen::Vector3d in_camera;  // the point in the camera's frame
    Eigen::Matrix3d hessian;    // by in_camera
    Eigen::Vector3d gradient;   // by in_camera
    Eigen::Matrix3d by_point;   // by in_camera and the point
  };
  Derivatives derive(const Observation& o, const State& state) const;
  void add(const Observation& o, const State& state, Point* point);
  // Returns the mixed second derivative by view and point. It is computed again each time: to keep those of all
  // observations would take more memory than all else.
  Matrix63d mixed(const Observation& o, const State& state) const;
  // Eliminates a point from the views' system (Schur complement): subtracts its part from system_ and right_. Keeps the
  // inverse of its damped hessian.
  void eliminate(const State& state, Point* point, double damping);
  Eigen::Vector3d back_substitute(const State& state, const Point& point) const;

  Huber huber_;
  std::vector<Observation> observations_;  // sorted by point
  std::vector<Point> points_;
  std::vector<Unknown> free_;
  std::vector<int> unknown_of_;  // by view: index in free_; -1 if it is fixed or sees no point
  // Scratch of eliminate(), by observation of its point: mixed(), and mixed() * Point::inverse. Not used for fixed
  // views.
  std::vector<Matrix63d> mixed_, weighted_;
  std::optional<BlockMatrix> system_;  // system of the views, without the points
  Eigen::VectorXd right_, twists_;     // right side and solution of system_
};

NormalEquations::NormalEquations(const Camera& camera, const BundleOptions& options, const BundleProblem& problem,
                                 const std::vector<char>& used)
    : huber_{options.huber_chi2}, points_(problem.points.size()), unknown_of_(problem.views.size(), -1) {
  const auto counts = [&used](size_t i) { return used.empty() || used[i]; };
  const std::vector<BundleProblem::Observation>& all = problem.observations;
  int count = 0;
  for (size_t i = 0; i < all.size(); ++i) {
    if (!counts(i)) continue;
    ++count;
    ++points_[all[i].point].end;
    if (!problem.views[all[i].view].fixed) unknown_of_[all[i].view] = 0;
  }
  for (size_t v = 0; v < unknown_of_.size(); ++v) {
    if (unknown_of_[v] < 0) continue;
    unknown_of_[v] = static_cast<int>(free_.size());
    free_.push_back({static_cast<int>(v), Matrix6d::Zero(), Vector6d::Zero()});
  }
  int begin = 0;
  for (Point& p : points_) {
    p.begin = begin;
    begin += std::exchange(p.end, begin);
  }
  observations_.resize(count);
  for (size_t i = 0; i < all.size(); ++i)
    if (const BundleProblem::Observation& o = all[i]; counts(i))
      observations_[points_[o.point].end++] = {o.view, o.point, {camera, o.pixel, o.sigma_px, o.whitening}};
  const auto earlier = [this](const Observation& a, const Observation& b) {
    return unknown_of_[a.view] < unknown_of_[b.view];
  };
  for (const Point& p : points_) {
    const auto first = observations_.begin() + p.begin, last = observations_.begin() + p.end;
    if (!std::is_sorted(first, last, earlier)) std::sort(first, last, earlier);
  }
  system_.emplace(pattern());
}

// Returns for each free view the free views, up to itself, that observe a common point. If there are only a few views,
// it returns all of them.
std::vector<std::vector<int>> NormalEquations::pattern() const {
  const auto n = static_cast<int>(free_.size());
  std::vector<std::vector<int>> columns(n);
  if (n <= ReducedSolver::kSmall) {
    for (int row = 0; row < n; ++row)
      for (int column = 0; column <= row; ++column) columns[row].push_back(column);
    return columns;
  }
  std::vector<std::vector<int>> points_of(n);
  for (const Observation& o : observations_)
    if (unknown_of_[o.view] >= 0) points_of[unknown_of_[o.view]].push_back(o.point);
  std::vector<int> met(n, -1);
  for (int row = 0; row < n; ++row) {
    for (int p : points_of[row])
      for (int i = points_[p].begin; i < points_[p].end; ++i) {
        const int column = unknown_of_[observations_[i].view];
        if (column < 0 || column > row || met[column] == row) continue;
        met[column] = row;
        columns[row].push_back(column);
      }
    std::sort(columns[row].begin(), columns[row].end());
  }
  return columns;
}

double NormalEquations::cost(const State& state) const {
  double sum = 0;
  for (const Observation& o : observations_) {
    const View& view = state.views[o.view];
    const Eigen::Vector3d p = view.rotation * state.points[o.point] + view.cam_from_submap.translation;
    if (!(p.z() > 1e-9)) return kInfinity;
    sum += huber_.rho(o.projection.error(p).squaredNorm());
  }
  return sum / 2;
}

void NormalEquations::linearize(const State& state) {
  for (Unknown& f : free_) {
    f.hessian.setZero();
    f.gradient.setZero();
  }
  for (Point& point : points_) {
    point.hessian.setZero();
    point.gradient.setZero();
    for (int i = point.begin; i < point.end; ++i) add(observations_[i], state, &point);
  }
}

NormalEquations::Derivatives NormalEquations::derive(const Observation& o, const State& state) const {
  const View& view = state.views[o.view];
  Derivatives d;
  d.in_camera = view.rotation * state.points[o.point] + view.cam_from_submap.translation;
  const Eigen::Vector2d error = o.projection.error(d.in_camera);
  o.projection.normal_equations(d.in_camera, error, huber_.weight(error.squaredNorm()), &d.hessian, &d.gradient);
  d.by_point = d.hessian * view.rotation;
  return d;
}

void NormalEquations::add(const Observation& o, const State& state, Point* point) {
  const Derivatives d = derive(o, state);
  const Eigen::Matrix3d& rotation = state.views[o.view].rotation;
  point->hessian.noalias() += rotation.transpose() * d.by_point;
  point->gradient.noalias() += rotation.transpose() * d.gradient;
  if (unknown_of_[o.view] < 0) return;
  // A twist moves the view by exp(twist) on the left, and the point by its translation + its rotation x the point.
  Unknown& unknown = free_[unknown_of_[o.view]];
  const Eigen::Matrix3d cross = skew(d.in_camera);
  const Eigen::Matrix3d turned = cross * d.hessian;
  unknown.hessian.topLeftCorner<3, 3>() += d.hessian;
  unknown.hessian.bottomLeftCorner<3, 3>() += turned;
  unknown.hessian.bottomRightCorner<3, 3>().noalias() -= turned * cross;
  unknown.gradient.head<3>() += d.gradient;
  unknown.gradient.tail<3>() += d.in_camera.cross(d.gradient);
}

Matrix63d NormalEquations::mixed(const Observation& o, const State& state) const {
  const Derivatives d = derive(o, state);
  Matrix63d mixed;
  mixed.topRows<3>() = d.by_point;
  mixed.bottomRows<3>().noalias() = skew(d.in_camera) * d.by_point;
  return mixed;
}

template <typename Matrix>
void damp(double damping, Matrix* hessian) {
  for (int i = 0; i < hessian->rows(); ++i) (*hessian)(i, i) += damping * std::max((*hessian)(i, i), kMinDiagonal);
}

// Computes result -= a * b^T. A quarter faster than Eigen's product, because it works on whole columns of a.
void subtract_product(const Matrix63d& a, const Matrix63d& b, Matrix6d* result) {
  for (int c = 0; c < 6; ++c) result->col(c).noalias() -= a.col(0) * b(c, 0) + a.col(1) * b(c, 1) + a.col(2) * b(c, 2);
}

bool is_before(const BlockMatrix::Entry& entry, int column) { return entry.column < column; }

void NormalEquations::eliminate(const State& state, Point* point, double damping) {
  Eigen::Matrix3d damped = point->hessian;
  damp(damping, &damped);
  point->inverse = damped.inverse();
  mixed_.resize(point->end - point->begin);
  weighted_.resize(mixed_.size());
  for (int i = point->begin; i < point->end; ++i) {
    const int row = unknown_of_[observations_[i].view];
    if (row < 0) continue;
    mixed_[i - point->begin] = mixed(observations_[i], state);
    Matrix63d& weighted = weighted_[i - point->begin];
    weighted.noalias() = mixed_[i - point->begin] * point->inverse;
    right_.segment<6>(6 * row).noalias() += weighted * point->gradient;
  }
  for (int i = point->begin; i < point->end; ++i) {
    const int row = unknown_of_[observations_[i].view];
    if (row < 0) continue;
    std::vector<BlockMatrix::Entry>& entries = system_->row(row);
    const bool has_all = static_cast<int>(entries.size()) == row + 1;
    auto entry = entries.begin();
    for (int k = point->begin; k < point->end; ++k) {
      const int column = unknown_of_[observations_[k].view];
      if (column < 0) continue;
      if (column > row) break;
      entry = has_all ? entries.begin() + column : std::lower_bound(entry, entries.end(), column, is_before);
      subtract_product(weighted_[i - point->begin], mixed_[k - point->begin], &entry->block);
    }
  }
}

Eigen::Vector3d NormalEquations::back_substitute(const State& state, const Point& point) const {
  Eigen::Vector3d right = -point.gradient;
  for (int i = point.begin; i < point.end; ++i) {
    const int row = unknown_of_[observations_[i].view];
    if (row >= 0) right.noalias() -= mixed(observations_[i], state).transpose() * twists_.segment<6>(6 * row);
  }
  return point.inverse * right;
}

std::optional<State> NormalEquations::step(const State& from, double damping, ReducedSolver* solver,
                                           double* predicted) {
  const auto n = static_cast<int>(free_.size());
  system_->set_zero();
  right_.resize(6 * n);
  for (int i = 0; i < n; ++i) {
    Matrix6d damped = free_[i].hessian.selfadjointView<Eigen::Lower>();
    damp(damping, &damped);
    system_->diagonal(i) = damped;
    right_.segment<6>(6 * i) = -free_[i].gradient;
  }
  for (Point& point : points_)
    if (point.begin < point.end) eliminate(from, &point, damping);
  if (!solver->solve(*system_, right_, &twists_)) return std::nullopt;

  // The prediction is half of step * (damping * diagonal * step - gradient).
  double twice = 0;
  const auto predict = [&](const auto& step, const auto& gradient, const auto& hessian) {
    twice -= step.dot(gradient);
    for (Eigen::Index i = 0; i < step.size(); ++i)
      twice += damping * std::max(hessian(i, i), kMinDiagonal) * step[i] * step[i];
  };
  State to = from;
  for (int i = 0; i < n; ++i) {
    const Vector6d twist = twists_.segment<6>(6 * i);
    predict(twist, free_[i].gradient, free_[i].hessian);
    View& view = to.views[free_[i].view];
    view.cam_from_submap = SE3::exp(twist) * view.cam_from_submap;
    view.rotation = view.cam_from_submap.rotation.toRotationMatrix();
  }
  for (size_t p = 0; p < points_.size(); ++p) {
    if (points_[p].begin == points_[p].end) continue;
    const Eigen::Vector3d move = back_substitute(from, points_[p]);
    predict(move, points_[p].gradient, points_[p].hessian);
    to.points[p] += move;
  }
  *predicted = twice / 2;
  return to;
}

State state_of(const BundleProblem& problem) {
  State state{{}, problem.points};
  for (const BundleProblem::View& v : problem.views)
    state.views.push_back({v.cam_from_submap, v.cam_from_submap.rotation.toRotationMatrix()});
  return state;
}

}  // namespace

BundleReport BundleSolver::solve(const Camera& camera, const BundleOptions& options, BundleProblem* problem,
                                 const std::vector<char>& used) {
  constexpr double kMinGain = 1e-3;  // a step that gains a smaller part of the predicted decrease is undone
  BundleReport report;
  NormalEquations bundle(camera, options, *problem, used);
  State state = state_of(*problem);
  double cost = bundle.cost(state);
  if (!bundle.has_free_views() || !std::isfinite(cost)) return report;
  report.initial_cost = cost;
  TrustRegion region;
  bool moved = true, converged = false;
  while (report.iterations < options.iterations && !converged && !(options.cancel && *options.cancel)) {
    ++report.iterations;
    if (std::exchange(moved, false)) bundle.linearize(state);
    double predicted = 0;
    std::optional<State> next = bundle.step(state, region.damping(), solver_.get(), &predicted);
    const double next_cost = next ? bundle.cost(*next) : kInfinity;
    const double decrease = cost - next_cost;
    converged = std::abs(decrease) <= options.function_tolerance * cost;
    moved = predicted > 0 && decrease > kMinGain * predicted;
    if (!moved) {
      region.refuse();
      continue;
    }
    region.accept(decrease / predicted);
    state = *std::move(next);
    cost = next_cost;
  }
  report.usable = true;
  report.final_cost = cost;
  for (size_t v = 0; v < state.views.size(); ++v) problem->views[v].cam_from_submap = state.views[v].cam_from_submap;
  problem->points = std::move(state.points);
  return report;
}

BundleSolver::BundleSolver() : solver_(std::make_unique<ReducedSolver>()) {}
BundleSolver::~BundleSolver() = default;

BundleReport solve_bundle(const Camera& camera, const BundleOptions& options, BundleProblem* problem) {
  return BundleSolver().solve(camera, options, problem);
}

double reprojection_chi2(const Camera& camera, const BundleProblem& problem, const BundleProblem::Observation& o) {
  const Eigen::Vector3d p = problem.views[o.view].cam_from_submap * problem.points[o.point];
  if (!(p.z() > 1e-9)) return std::numeric_limits<double>::infinity();
  return (o.whitening * (camera.project_undistorted(p) - o.pixel)).squaredNorm() / (o.sigma_px * o.sigma_px);
}

}  // namespace rumi
