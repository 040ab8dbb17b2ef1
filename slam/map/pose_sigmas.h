// SPDX-License-Identifier: BSD-3-Clause
// The standard deviations of a pose, as they are on the wire (see lcmtypes/track.lcm).
#pragma once

namespace rumi {

// Either all three are known, or none is (-1).
struct PoseSigmas {
  float position = -1;      // one coordinate of the camera's centre, in the pose's unit
  float rotation_rad = -1;  // rotation about one axis
  float log_scale = -1;     // logarithm of the submap's unit there, against its unit at the beginning

  bool are_known() const { return position > 0; }
  bool operator==(const PoseSigmas&) const = default;
};

// Returns unknown sigmas unless position and rotation are above 0, log_scale is at least 0, and none is NaN or above
// 1e6. All zeros, as in a message that nobody filled in, are unknown too.
PoseSigmas pose_sigmas(double position, double rotation_rad, double log_scale);
// The same sigmas in a new unit, of which the old one has `scale`.
PoseSigmas scaled(const PoseSigmas& sigmas, double scale);

}  // namespace rumi
