// SPDX-License-Identifier: BSD-3-Clause
// The standard deviations of a pose, as in messages (see lcmtypes/track.lcm).
#pragma once

namespace rumi {

// Either all three are known, or all are -1.
struct PoseSigmas {
  float position = -1;      // deviation of one coordinate of the camera's centre, in the pose's unit
  float rotation_rad = -1;  // deviation of the rotation about one axis
  float log_scale = -1;     // deviation of the log of the submap's unit at the pose, relative to its unit at the
                            // beginning

  bool are_known() const { return position > 0; }
  bool operator==(const PoseSigmas&) const = default;
};

// Returns unknown sigmas unless position and rotation are above 0, log_scale is at least 0, and none is NaN or above
// 1e6. All zeros, as in a message that nobody filled in, are unknown too.
PoseSigmas pose_sigmas(double position, double rotation_rad, double log_scale);
// Converts sigmas to another unit of length. `scale`: the old unit, measured in the new one.
PoseSigmas scaled(const PoseSigmas& sigmas, double scale);

}  // namespace rumi
