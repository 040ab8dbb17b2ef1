// SPDX-License-Identifier: BSD-3-Clause
#include "slam/geometry/transform.h"

#include <cmath>

namespace rumi {

Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Eigen::Quaterniond so3_exp(const Eigen::Vector3d& rotation_vector) {
  const double angle = rotation_vector.norm();
  const double half = 0.5 * angle;
  // sin(x/2)/x by its series near zero, where the quotient loses digits.
  const double k = angle < 1e-6 ? 0.5 - angle * angle / 48.0 : std::sin(half) / angle;
  const Eigen::Vector3d v = k * rotation_vector;
  return Eigen::Quaterniond(std::cos(half), v.x(), v.y(), v.z());
}

Eigen::Vector3d so3_log(const Eigen::Quaterniond& q) {
  const double sign = q.w() < 0 ? -1.0 : 1.0;  // takes q or -q, whichever has the smaller angle
  const Eigen::Vector3d v = sign * q.vec();
  const double n = v.norm();
  if (n < 1e-9) return 2.0 * v;
  return v * (2.0 * std::atan2(n, sign * q.w()) / n);
}

double SE3::angle_rad() const { return so3_log(rotation).norm(); }

Eigen::Matrix3d so3_left_jacobian(const Eigen::Vector3d& w) {
  const double a2 = w.squaredNorm();
  const double a = std::sqrt(a2);
  const Eigen::Matrix3d s = skew(w);
  if (a < 1e-6) return Eigen::Matrix3d::Identity() + 0.5 * s + s * s / 6.0;
  return Eigen::Matrix3d::Identity() + (1 - std::cos(a)) / a2 * s + (a - std::sin(a)) / (a2 * a) * s * s;
}

SE3 SE3::exp(const Vector6d& twist) {
  const Eigen::Vector3d w = twist.tail<3>();
  return {so3_exp(w), so3_left_jacobian(w) * twist.head<3>()};
}

Eigen::Quaterniond shortest_turn(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  return Eigen::Quaterniond::FromTwoVectors(from, to);
}

Vector6d SE3::log() const {
  const Eigen::Vector3d w = so3_log(rotation);
  Vector6d twist;
  twist << so3_left_jacobian(w).inverse() * translation, w;
  return twist;
}

Sim3 Sim3::plus(const Vector7d& step, const Eigen::Vector3d& pivot) const {
  const double s = scale * std::exp(step[6]);
  const Eigen::Quaterniond q = so3_exp(step.head<3>()) * rotation;
  return {s, q, *this * pivot + step.segment<3>(3) - s * (q * pivot)};
}

Vector7d Sim3::minus(const Sim3& from, const Eigen::Vector3d& pivot) const {
  Vector7d step;
  step << so3_log(rotation * from.rotation.conjugate()), *this * pivot - from * pivot, std::log(scale / from.scale);
  return step;
}

SE3 interpolate(const SE3& a, const SE3& b, double fraction) {
  return {a.rotation.slerp(fraction, b.rotation), (1 - fraction) * a.translation + fraction * b.translation};
}

}  // namespace rumi
