// SPDX-License-Identifier: BSD-3-Clause
// Converts poses and their uncertainties to and from messages (lcmtypes/pose.lcm, track.lcm).
#pragma once

#include <optional>

#include "lcmtypes/rumi/rigid_t.hpp"
#include "lcmtypes/rumi/rigid_transform_t.hpp"
#include "lcmtypes/rumi/similarity_t.hpp"
#include "slam/geometry/transform.h"
#include "slam/map/submap.h"

namespace rumi {

rigid_t to_wire(const SE3& pose);
similarity_t to_wire(const Sim3& similarity);
rigid_transform_t to_wire(int64_t utime, const SE3& pose);

// Both return nullopt if a number is not finite, the length of the quaternion differs from 1 by more than 1e-3, or the
// scale is not above 0.
std::optional<SE3> from_wire(const rigid_t& pose);
std::optional<Sim3> from_wire(const similarity_t& similarity);

// Write the sigmas into a track_t or a frame_t, and read them from it. pose_sigmas() says which values mean that a
// sigma is not known.
template <class Wire>
void put_sigmas(const PoseSigmas& sigmas, Wire* wire) {
  wire->position_sigma = sigmas.position;
  wire->rotation_sigma_rad = sigmas.rotation_rad;
  wire->log_scale_sigma = sigmas.log_scale;
}
template <class Wire>
PoseSigmas sigmas_of(const Wire& wire) {
  return pose_sigmas(static_cast<double>(wire.position_sigma), static_cast<double>(wire.rotation_sigma_rad),
                     static_cast<double>(wire.log_scale_sigma));
}

}  // namespace rumi
