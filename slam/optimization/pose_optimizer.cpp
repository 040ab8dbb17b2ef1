// SPDX-License-Identifier: BSD-3-Clause
#include "slam/optimization/pose_optimizer.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "slam/optimization/whitened_projection.h"

namespace rumi {
namespace {

// A PointObservation, prepared for evaluation at many poses.
struct Sighting {
  Eigen::Vector3d point;
  WhitenedProjection projection;
  double weight;
};

// Returns the squared error in sigma^2; infinite if the point is behind the camera.
double chi2(const Sighting& s, const Eigen::Matrix3d& r, const Eigen::Vector3d& t) {
  const Eigen::Vector3d p = r * s.point + t;
  if (!(p.z() > 1e-6)) return std::numeric_limits<double>::infinity();
  return s.projection.error(p).squaredNorm();
}

double huber_cost(double e2, double delta2) { return e2 <= delta2 ? e2 : 2 * std::sqrt(delta2 * e2) - delta2; }

struct NormalEquations {
  Matrix6d h = Matrix6d::Zero();  // only the lower half is used
  Vector6d g = Vector6d::Zero();
  double cost = 0;
};

void add_sightings(const SE3& pose, const std::vector<Sighting>& sightings, const std::vector<bool>& use, bool robust,
                   double delta2, NormalEquations* n) {
  const Eigen::Matrix3d r = pose.rotation.toRotationMatrix();
  for (size_t i = 0; i < sightings.size(); ++i) {
    if (!use[i]) continue;
    const Eigen::Vector3d p = r * sightings[i].point + pose.translation;
    if (!(p.z() > 1e-6)) continue;
    const Eigen::Vector2d e = sightings[i].projection.error(p);
    const double e2 = e.squaredNorm();
    const double weight = sightings[i].weight;
    const double w = robust && e2 > delta2 ? weight * std::sqrt(delta2 / e2) : weight;
    n->cost += weight * (robust ? huber_cost(e2, delta2) : e2);
    // The twist in exp(twist) * pose moves p by its translation + its rotation x p.
    Eigen::Matrix3d hessian, turned;
    Eigen::Vector3d gradient;
    sightings[i].projection.normal_equations(p, e, w, &hessian, &gradient);
    for (int k = 0; k < 3; ++k) turned.col(k) = p.cross(hessian.col(k));
    n->h.topLeftCorner<3, 3>() += hessian;
    n->h.bottomLeftCorner<3, 3>() += turned;
    for (int k = 0; k < 3; ++k) n->h.block<3, 1>(3, 3 + k) += p.cross(turned.row(k).transpose());
    n->g.head<3>() += gradient;
    n->g.tail<3>() += p.cross(gradient);
  }
}

constexpr double kEpipolarChi2 = 3.841;  // squared error in sigma^2 up to which the weight is 1: 95 % of a 1-D normal
                                         // distribution

void add_epipolar(const Camera& camera, const SE3& pose, const EpipolarView& view, NormalEquations* n) {
  const double f = 0.5 * (camera.fx + camera.fy);
  const SE3 cam_from_view = pose * view.cam_from_submap.inverse();
  const Eigen::Matrix3d r = cam_from_view.rotation.toRotationMatrix();
  for (const EpipolarView::Match& match : view.matches) {
    // The epipolar constraint b·(t × R a) = 0, divided by the length of its gradient by both rays.
    const Eigen::Vector3d b = camera.ray(match.pixel), ra = r * camera.ray(match.pixel_there);
    const Eigen::Vector3d normal = cam_from_view.translation.cross(ra);
    const Eigen::Vector3d normal_there = r.transpose() * b.cross(cam_from_view.translation);
    const double gradient = std::sqrt(normal.head<2>().squaredNorm() + normal_there.head<2>().squaredNorm());
    if (!(gradient > 1e-9)) continue;  // no baseline, or not finite
    const double s = f / (match.sigma_px * gradient), e = s * b.dot(normal), e2 = e * e;
    const bool is_far = e2 > kEpipolarChi2;
    const double w = is_far ? kEpipolarChi2 * kEpipolarChi2 / (e2 * e2) : 1.0;
    n->cost += is_far ? kEpipolarChi2 * (2 - kEpipolarChi2 / e2) : e2;
    // The derivative by the twist, with `gradient` held fixed; by Jacobi's identity the rotation's part is (t × R a) ×
    // b.
    Vector6d j;
    j << s * ra.cross(b), s * normal.cross(b);
    n->h.noalias() += w * j * j.transpose();
    n->g.noalias() += w * e * j;
  }
}

// The observations and matches that a pose has to explain.
struct Seen {
  const std::vector<Sighting>& sightings;
  const std::vector<bool>& use;  // by sighting
  const std::vector<EpipolarView>& views;
};

NormalEquations linearize(const Camera& camera, const SE3& pose, const Seen& seen, bool robust, double delta2) {
  NormalEquations n;
  add_sightings(pose, seen.sightings, seen.use, robust, delta2, &n);
  for (const EpipolarView& view : seen.views) add_epipolar(camera, pose, view, &n);
  return n;
}

constexpr double kStalled = 1e-6;  // the steps end when one lowers the cost by a smaller part of it

// Takes Levenberg-Marquardt steps until the cost stalls. Returns false if the system is singular.
bool minimize(const Camera& camera, const Seen& seen, bool robust, const PoseOptimizerOptions& options, SE3* pose) {
  double lambda = 1e-6;
  NormalEquations n = linearize(camera, *pose, seen, robust, options.inlier_chi2);
  for (int i = 0; i < options.iterations; ++i) {
    Matrix6d h = n.h;
    h.diagonal() += lambda * n.h.diagonal() + Vector6d::Constant(1e-12);
    const Eigen::LDLT<Matrix6d> ldlt(h);
    const Vector6d step = -ldlt.solve(n.g);
    if (!step.allFinite()) return false;
    const SE3 moved = SE3::exp(step) * *pose;
    const NormalEquations next = linearize(camera, moved, seen, robust, options.inlier_chi2);
    if (next.cost > (1 + kStalled) * n.cost) {
      lambda = std::max(lambda * 10, 1e-4);
      if (lambda > 1e3) break;
      continue;
    }
    const bool stalled = n.cost - next.cost < kStalled * n.cost;
    *pose = moved;
    n = next;
    lambda = std::max(lambda * 0.1, 1e-9);
    if (stalled) break;
  }
  return true;
}

}  // namespace

PoseResult optimize_pose(const Camera& camera, const SE3& initial, const std::vector<PointObservation>& observations,
                         const PoseOptimizerOptions& options, const std::vector<EpipolarView>& views) {
  PoseResult result;
  result.cam_from_submap = initial;
  result.inlier.resize(observations.size());
  std::vector<Sighting> sightings;
  sightings.reserve(observations.size());
  for (const PointObservation& o : observations)
    sightings.push_back({o.point, {camera, o.pixel, o.sigma_px, o.whitening}, o.weight});
  const Eigen::Matrix3d r0 = initial.rotation.toRotationMatrix();
  for (size_t i = 0; i < sightings.size(); ++i) {
    const double e2 = chi2(sightings[i], r0, initial.translation);
    result.inlier[i] = !std::isnan(e2) && (e2 <= options.first_gate_chi2 || std::isinf(options.first_gate_chi2));
    result.inliers += result.inlier[i];
  }
  for (int round = 0; round < options.rounds; ++round) {
    if (result.inliers < 6) return result;
    // The last round trusts its inliers and minimizes squared errors; the earlier ones need the robust loss.
    const bool robust = round + 1 < options.rounds;
    SE3 pose = result.cam_from_submap;
    if (!minimize(camera, {sightings, result.inlier, views}, robust, options, &pose) || !pose.is_finite())
      return result;
    result.cam_from_submap = pose;
    const Eigen::Matrix3d r = pose.rotation.toRotationMatrix();
    const std::vector<bool> before = result.inlier;
    result.inliers = 0;
    double sum = 0;
    for (size_t i = 0; i < sightings.size(); ++i) {
      const double e2 = chi2(sightings[i], r, pose.translation);
      result.inlier[i] = e2 <= options.inlier_chi2;
      if (!result.inlier[i]) continue;
      ++result.inliers;
      sum += e2;
    }
    result.rmse_px = result.inliers ? std::sqrt(sum / result.inliers) : 0;
    // If the inliers are the same, another robust round would change nothing.
    if (robust && result.inlier == before) round = options.rounds - 2;
  }
  result.converged = result.inliers >= 6;
  return result;
}

Matrix6d epipolar_information(const Camera& camera, const SE3& cam_from_submap, const EpipolarView& view) {
  NormalEquations n;
  add_epipolar(camera, cam_from_submap, view, &n);
  return n.h;
}

}  // namespace rumi
