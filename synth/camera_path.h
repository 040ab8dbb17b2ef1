// SPDX-License-Identifier: BSD-3-Clause
// The camera's pose at any time, from a recorded trajectory or a made-up walk.
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
  // Reads a TUM trajectory (map_from_cam). An Error names file, line and value.
  static Result<CameraPath> load(const std::string& file);
  // Makes a walk as with a hand-held camera around the middle of a room. It is closed if it lasts 16 s or more. The
  // camera looks outwards, so that it moves sideways from the first frame on. z is up.
  static CameraPath walk(double seconds, uint64_t seed);

  // Appends a sample, which must be later than all others.
  void add(double time_s, const SE3& map_from_cam);

  // Returns map_from_cam. A time before the first sample or after the last one is replaced by that sample's.
  SE3 at(double time_s) const;
  const std::vector<double>& times_s() const { return times_s_; }
  // Returns the unit vector upwards in the map: the mean of the cameras' own "up", or a map axis close to it.
  Eigen::Vector3d up() const;
  // Returns the part of the path in [begin_s, end_s].
  CameraPath cut(double begin_s, double end_s) const;

 private:
  std::vector<double> times_s_;  // ascending
  std::vector<SE3> poses_;       // map_from_cam
};

}  // namespace rumi::synth
