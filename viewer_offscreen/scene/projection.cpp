// SPDX-License-Identifier: BSD-3-Clause
#include "viewer_offscreen/scene/projection.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace rumi::viewer_offscreen {
namespace {

using Eigen::Vector3d;

constexpr double kOutlierShare = 0.05;  // share of the landmarks that is left out at either end of a range
constexpr size_t kMaxSamples = 20'000;  // landmarks that are looked at, at most

struct Range {
  double low = 1e300, high = -1e300;
  void add(double v) {
    low = std::min(low, v);
    high = std::max(high, v);
  }
  void add(const Range& other) {
    low = std::min(low, other.low);
    high = std::max(high, other.high);
  }
  bool empty() const { return low > high; }
  double size() const { return empty() ? 0 : high - low; }
};

// Returns the range of the landmarks along a direction, without the outermost ones.
Range landmark_range(const std::vector<const SubmapView*>& submaps, const Vector3d& origin, const Vector3d& direction) {
  size_t all = 0;
  for (const SubmapView* s : submaps) all += s->landmarks.size();
  const size_t step = all / kMaxSamples + 1;
  std::vector<double> values;
  for (const SubmapView* s : submaps)
    for (size_t i = 0; i < s->landmarks.size(); i += step)
      values.push_back((s->landmarks[i].cast<double>() - origin).dot(direction));
  Range range;
  if (values.empty()) return range;
  const size_t cut = static_cast<size_t>(kOutlierShare * static_cast<double>(values.size()));
  std::nth_element(values.begin(), values.begin() + static_cast<ptrdiff_t>(cut), values.end());
  range.add(values[cut]);
  const size_t top = values.size() - 1 - cut;
  std::nth_element(values.begin(), values.begin() + static_cast<ptrdiff_t>(top), values.end());
  range.add(values[top]);
  return range;
}

Range trajectory_range(const std::vector<const SubmapView*>& submaps, const Vector3d& origin,
                       const Vector3d& direction) {
  Range range;
  for (const SubmapView* s : submaps)
    for (const TrajectoryPoint& p : s->trajectory) range.add((p.position - origin).dot(direction));
  return range;
}

// Returns the range of trajectory and landmarks. Landmarks enlarge it only to a limit, because far points would shrink
// the path to nothing.
Range fitted_range(const std::vector<const SubmapView*>& submaps, const Vector3d& origin, const Vector3d& direction,
                   double extent) {
  Range range = trajectory_range(submaps, origin, direction);
  Range landmarks = landmark_range(submaps, origin, direction);
  if (landmarks.empty()) return range;
  if (!range.empty()) {
    landmarks.low = std::max(landmarks.low, range.low - 1.2 * extent);
    landmarks.high = std::min(landmarks.high, range.high + 1.2 * extent);
  }
  range.add(landmarks);
  return range;
}

}  // namespace

PrincipalPlane principal_plane(const std::vector<const SubmapView*>& submaps) {
  PrincipalPlane plane;
  Vector3d sum = Vector3d::Zero(), up = Vector3d::Zero(), first = Vector3d::Zero();
  double n = 0;
  for (const SubmapView* s : submaps) {
    for (const TrajectoryPoint& p : s->trajectory) {
      if (n == 0) first = p.position;
      sum += p.position;
      ++n;
    }
    for (const KeyframeView& view : s->keyframe_poses) up -= view.map_from_cam.rotation * Vector3d::UnitY();
  }
  if (n == 0) return plane;
  plane.center = sum / n;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const SubmapView* s : submaps)
    for (const TrajectoryPoint& p : s->trajectory)
      spread += (p.position - plane.center) * (p.position - plane.center).transpose() / n;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
  const Vector3d& variance = solver.eigenvalues();  // ascending
  Vector3d normal = solver.eigenvectors().col(0), major = solver.eigenvectors().col(2);
  if (up.norm() < 1e-9) up = normal;
  // If the path is a line, it lies in many planes: take the one that is level for the cameras.
  if (variance[1] < 1e-3 * variance[2] || variance[2] <= 0) {
    if (variance[2] <= 0) major = up.unitOrthogonal();
    const Vector3d level = up - up.dot(major) * major;
    normal = level.norm() > 1e-6 * up.norm() ? level.normalized() : major.unitOrthogonal();
  }
  if (normal.dot(up) < 0) normal = -normal;
  if ((first - plane.center).dot(major) > 0) major = -major;  // the path starts on the left
  plane.axes << major, normal.cross(major), normal;

  double extent = 0;
  for (int axis = 0; axis < 3; ++axis)
    extent = std::max(extent, trajectory_range(submaps, plane.center, plane.axes.col(axis)).size());
  const double landmarks = landmark_range(submaps, plane.center, major).size();
  plane.extent = extent > 0 ? extent : (landmarks > 0 ? landmarks : 1);
  const Range height = fitted_range(submaps, plane.center, normal, 0.3 * plane.extent);
  plane.floor = std::min(height.low, -0.05 * plane.extent);
  return plane;
}

Projection Projection::parallel(const PrincipalPlane& plane, double azimuth_rad, double elevation_rad,
                                const cv::Rect& panel, const std::vector<const SubmapView*>& submaps) {
  const double ca = std::cos(azimuth_rad), sa = std::sin(azimuth_rad), ce = std::cos(elevation_rad),
               se = std::sin(elevation_rad);
  const Vector3d right = plane.axes * Vector3d(ca, sa, 0), up = plane.axes * Vector3d(-sa * se, ca * se, ce);
  const Range x = fitted_range(submaps, plane.center, right, plane.extent),
              y = fitted_range(submaps, plane.center, up, plane.extent);
  Vector3d origin = plane.center;
  if (!x.empty()) origin += right * (x.low + x.high) / 2 + up * (y.low + y.high) / 2;
  constexpr double kMargin = 0.9;
  const double smallest = 0.1 * plane.extent;
  const double scale =
      kMargin * std::min(panel.width / std::max(x.size(), smallest), panel.height / std::max(y.size(), smallest));
  Projection project;
  project.scale_ = scale;
  project.matrix_.row(0) << scale * right.transpose(), panel.x + panel.width / 2.0 - scale * right.dot(origin);
  project.matrix_.row(1) << -scale * up.transpose(), panel.y + panel.height / 2.0 + scale * up.dot(origin);
  project.matrix_(2, 3) = 1;
  return project;
}

Projection Projection::follow(const PrincipalPlane& plane, const SE3& map_from_cam, const cv::Rect& panel) {
  constexpr double kBehind = 0.34, kAbove = 0.14, kAhead = 0.6;  // as shares of plane.extent
  constexpr double kField = 1.0;                                 // width of the panel at distance 1
  const Vector3d forward = map_from_cam.rotation * Vector3d::UnitZ();
  Vector3d up = plane.axes.col(2);
  if (std::abs(forward.dot(up)) > 0.9) up = -(map_from_cam.rotation * Vector3d::UnitY());
  const Vector3d at = map_from_cam.translation;
  const Vector3d eye = at + plane.extent * (kAbove * up - kBehind * forward);
  const Vector3d z = (at + plane.extent * kAhead * forward - eye).normalized(), x = z.cross(up).normalized(),
                 y = z.cross(x);
  const double focal = panel.width / kField;
  const Eigen::RowVector3d depth = z.transpose();
  Projection project;
  const auto row = [&](const Vector3d& axis, double center) -> Eigen::RowVector4d {
    const Eigen::RowVector3d direction = focal * axis.transpose() + center * depth;
    return (Eigen::RowVector4d() << direction, -direction.dot(eye)).finished();
  };
  project.matrix_.row(0) = row(x, panel.x + panel.width / 2.0);
  project.matrix_.row(1) = row(y, panel.y + panel.height / 2.0);
  project.matrix_.row(2) << depth, -depth.dot(eye);
  project.near_ = 0.02 * plane.extent;
  return project;
}

cv::Point2d Projection::operator()(const Vector3d& map) const {
  const Vector3d p = matrix_ * map.homogeneous();
  return {p.x() / p.z(), p.y() / p.z()};
}

bool Projection::clip(Vector3d* a, Vector3d* b) const {
  const double da = depth(*a) - near_, db = depth(*b) - near_;
  if (!(da >= 0 || db >= 0)) return false;
  const Vector3d cut = *a + (*b - *a) * (da / (da - db));
  if (da < 0) *a = cut;
  if (db < 0) *b = cut;
  return true;
}

double round_length(double length) {
  if (!(length > 0) || !std::isfinite(length)) return 1;
  const double power = std::pow(10, std::floor(std::log10(length)));
  const double digit = length / power;
  return power * (digit < 1.5 ? 1 : digit < 3.5 ? 2 : digit < 7.5 ? 5 : 10);
}

}  // namespace rumi::viewer_offscreen
