// SPDX-License-Identifier: BSD-3-Clause
// The motion of a hand-held camera. z is up.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

#include "slam/geometry/transform.h"

namespace rumi::synth {

// Sum of a few sines with random phases: repeatable, smooth, never the same twice.
class Wobble {
 public:
  Wobble(cv::RNG& rng, std::vector<double> frequencies_hz);
  // Within [-1, 1].
  double at(double t) const;

 private:
  std::vector<double> frequencies_hz_, phases_;
};

// map_from_cam of a camera at `position` that looks along yaw (about z, up) and pitch (upwards).
SE3 look(const Eigen::Vector3d& position, double yaw_rad, double pitch_rad, double roll_rad);

}  // namespace rumi::synth
