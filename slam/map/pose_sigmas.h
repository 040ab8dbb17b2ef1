// SPDX-License-Identifier: BSD-3-Clause
// How well a pose is known: standard deviations, as they are on the wire (lcmtypes/track.lcm says of what).
#pragma once

namespace rumi {

// All three are known, or none.
struct PoseSigmas {
  float position = -1;      // of one coordinate of the camera's centre, in the unit of the pose
  float rotation_rad = -1;  // about one axis
  float log_scale = -1;     // of the logarithm of the submap's unit there, against its beginning

  bool are_known() const { return position > 0; }
  bool operator==(const PoseSigmas&) const = default;
};

// Not known unless position and rotation are above 0, log_scale is not below 0, and none is above 1e6 or NaN. So are
// zeros, which are what a message holds that nobody filled in.
PoseSigmas pose_sigmas(double position, double rotation_rad, double log_scale);
// The same for a pose whose unit is `scale` times as large in the new one.
PoseSigmas scaled(const PoseSigmas& sigmas, double scale);

}  // namespace rumi
