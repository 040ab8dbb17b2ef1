// SPDX-License-Identifier: BSD-3-Clause
// Where the camera is at any time: a recorded trajectory or a walk that is made up.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "base/result.h"
#include "slam/geometry/transform.h"

namespace rumi::synth {

class CameraPath {
 public:
  // A TUM trajectory, map_from_cam. An Error names file, line and value.
  static Result<CameraPath> load(const std::string& file);
  // A handheld-like walk around the middle of a room, closed if it lasts 16 s or more. The camera looks outwards and
  // about, so that it moves sideways from the first frame on. z is up.
  static CameraPath walk(double seconds, uint64_t seed);

  // One more sample, later than all others.
  void add(double time_s, const SE3& map_from_cam);

  // map_from_cam; times outside are clamped to the ends.
  SE3 at(double time_s) const;
  const std::vector<double>& times_s() const { return times_s_; }
  // Unit vector upwards in the map: the mean of the cameras' own "up", or the map axis near it.
  Eigen::Vector3d up() const;
  // The part in [begin_s, end_s].
  CameraPath cut(double begin_s, double end_s) const;

 private:
  std::vector<double> times_s_;  // ascending
  std::vector<SE3> poses_;       // map_from_cam
};

}  // namespace rumi::synth
