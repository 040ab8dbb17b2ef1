// SPDX-License-Identifier: BSD-3-Clause
#include "bus/wire/pose.h"

#include <cmath>

namespace rumi {
namespace {

constexpr double kUnitTolerance = 1e-3;       // how far a quaternion's length may be from 1
constexpr double kRoundingTolerance = 1e-12;  // a length nearer to 1 is not normalized: a round trip keeps every bit

template <class Wire>
void put(const Eigen::Quaterniond& q, const Eigen::Vector3d& t, Wire* wire) {
  for (int i = 0; i < 3; ++i) wire->trans[i] = t[i];
  wire->quat[0] = q.w(), wire->quat[1] = q.x(), wire->quat[2] = q.y(), wire->quat[3] = q.z();
}

template <class Wire, class Transform>
bool take(const Wire& wire, Transform* transform) {
  transform->rotation = Eigen::Quaterniond(wire.quat[0], wire.quat[1], wire.quat[2], wire.quat[3]);
  transform->translation = Eigen::Vector3d(wire.trans[0], wire.trans[1], wire.trans[2]);
  if (!transform->is_finite()) return false;
  const double length = transform->rotation.norm();
  if (std::abs(length - 1.0) > kUnitTolerance) return false;
  if (std::abs(length - 1.0) > kRoundingTolerance) transform->rotation.normalize();
  return true;
}

}  // namespace

rigid_t to_wire(const SE3& pose) {
  rigid_t wire;
  put(pose.rotation, pose.translation, &wire);
  return wire;
}

similarity_t to_wire(const Sim3& similarity) {
  similarity_t wire;
  wire.scale = similarity.scale;
  put(similarity.rotation, similarity.translation, &wire);
  return wire;
}

rigid_transform_t to_wire(int64_t utime, const SE3& pose) {
  rigid_transform_t wire;
  wire.utime = utime;
  put(pose.rotation, pose.translation, &wire);
  return wire;
}

std::optional<SE3> from_wire(const rigid_t& pose) {
  SE3 result;
  if (!take(pose, &result)) return std::nullopt;
  return result;
}

std::optional<Sim3> from_wire(const similarity_t& similarity) {
  Sim3 result;
  result.scale = similarity.scale;
  if (!take(similarity, &result) || similarity.scale <= 0) return std::nullopt;
  return result;
}

}  // namespace rumi
