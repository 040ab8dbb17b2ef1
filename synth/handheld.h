// SPDX-License-Identifier: BSD-3-Clause
// The motion of a hand-held camera. z is up.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

#include "slam/geometry/transform.h"

namespace rumi::synth {

// A sum of a few sines with random phases: smooth, and repeatable with the same seed.
class Wobble {
 public:
  Wobble(cv::RNG& rng, std::vector<double> frequencies_hz);
  // Returns a value in [-1, 1].
  double at(double t) const;

 private:
  std::vector<double> frequencies_hz_, phases_;
};

// Returns map_from_cam of a camera at `position` that looks along yaw (about z, which is up) and pitch (upwards).
SE3 look(const Eigen::Vector3d& position, double yaw_rad, double pitch_rad, double roll_rad);

}  // namespace rumi::synth
