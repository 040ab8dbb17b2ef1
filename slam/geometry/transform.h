// SPDX-License-Identifier: BSD-3-Clause
// Rigid (SE3) and similarity (Sim3) transforms. Names read target_from_source: c_from_a = c_from_b * b_from_a.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

namespace rumi {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector7d = Eigen::Matrix<double, 7, 1>;

// x_target = rotation * x_source + translation.
struct SE3 {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  SE3() = default;
  SE3(const Eigen::Quaterniond& q, const Eigen::Vector3d& t) : rotation(q.normalized()), translation(t) {}
  SE3(const Eigen::Matrix3d& r, const Eigen::Vector3d& t) : SE3(Eigen::Quaterniond(r), t) {}

  SE3 inverse() const {
    const Eigen::Quaterniond q = rotation.conjugate();
    return {q, -(q * translation)};
  }
  SE3 operator*(const SE3& b) const { return {rotation * b.rotation, rotation * b.translation + translation}; }
  Eigen::Vector3d operator*(const Eigen::Vector3d& p) const { return rotation * p + translation; }
  // Returns the target's origin in the source. For cam_from_submap it is the camera's centre in the submap.
  Eigen::Vector3d center() const { return -(rotation.conjugate() * translation); }
  // Returns the rotation's angle in radians, 0 to pi.
  double angle_rad() const;
  bool is_finite() const { return rotation.coeffs().allFinite() && translation.allFinite(); }

  // exp() maps a twist (translation part first, then rotation vector) to a transform; log() is its inverse.
  static SE3 exp(const Vector6d& twist);
  Vector6d log() const;
};

// x_target = scale * rotation * x_source + translation.
struct Sim3 {
  double scale = 1.0;
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Sim3() = default;
  Sim3(double s, const Eigen::Quaterniond& q, const Eigen::Vector3d& t)
      : scale(s), rotation(q.normalized()), translation(t) {}
  explicit Sim3(const SE3& rigid) : rotation(rigid.rotation), translation(rigid.translation) {}

  Sim3 inverse() const {
    const Eigen::Quaterniond q = rotation.conjugate();
    return {1.0 / scale, q, -(q * translation) / scale};
  }
  Sim3 operator*(const Sim3& b) const {
    return {scale * b.scale, rotation * b.rotation, scale * (rotation * b.translation) + translation};
  }
  Eigen::Vector3d operator*(const Eigen::Vector3d& p) const { return scale * (rotation * p) + translation; }
  bool is_finite() const { return std::isfinite(scale) && rotation.coeffs().allFinite() && translation.allFinite(); }
  // Returns the pose of a camera in the target, in the target's unit of length, from its pose in the source.
  SE3 transform_camera(const SE3& cam_from_source) const {
    const Eigen::Quaterniond q = cam_from_source.rotation * rotation.conjugate();
    return {q, scale * cam_from_source.translation - q * translation};
  }

  // plus() takes a step to a neighbouring similarity; minus() returns the step from `from` to this one, so that
  // a.plus(b.minus(a, p), p) == b. A step has seven independent numbers: rotation vector (rad, in the target's axes),
  // the displacement of `pivot` (a point of the source) in the target, and the logarithm of the ratio of the scales.
  Sim3 plus(const Vector7d& step, const Eigen::Vector3d& pivot = Eigen::Vector3d::Zero()) const;
  Vector7d minus(const Sim3& from, const Eigen::Vector3d& pivot = Eigen::Vector3d::Zero()) const;
};

// Returns target_from_source with the given scale, from the poses of one camera in both coordinate systems.
inline Sim3 similarity_through(const SE3& cam_from_source, const SE3& cam_from_target, double scale) {
  const Eigen::Quaterniond rotation = cam_from_target.rotation.conjugate() * cam_from_source.rotation;
  return {scale, rotation, cam_from_target.center() - scale * (rotation * cam_from_source.center())};
}

// Convert between a rotation vector (angle * axis, radians) and a quaternion.
Eigen::Quaterniond so3_exp(const Eigen::Vector3d& rotation_vector);
Eigen::Vector3d so3_log(const Eigen::Quaterniond& q);
// Returns the smallest rotation that takes the direction `from` to `to`. It wraps Eigen's function, so that only one
// file compiles it: for opposite directions that needs a singular value decomposition, eight seconds of compiling.
Eigen::Quaterniond shortest_turn(const Eigen::Vector3d& from, const Eigen::Vector3d& to);
Eigen::Matrix3d skew(const Eigen::Vector3d& v);
// Returns J with so3_exp(w + d) = so3_exp(J d) * so3_exp(w) for small d (Barfoot, State Estimation for Robotics, eq.
// 7.37).
Eigen::Matrix3d so3_left_jacobian(const Eigen::Vector3d& w);

// Interpolates from a (fraction 0) to b (fraction 1): the rotation by slerp, `translation` linearly. The translation of
// a map_from_cam is the camera's centre.
SE3 interpolate(const SE3& a, const SE3& b, double fraction);

}  // namespace rumi
