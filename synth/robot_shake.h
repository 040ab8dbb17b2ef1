// SPDX-License-Identifier: BSD-3-Clause
// How a small robot on paving shakes its camera.
#pragma once

#include <cstdint>
#include <memory>

#include "synth/handheld.h"

namespace rumi::synth {

class RobotShake {
 public:
  explicit RobotShake(uint64_t seed);
  // Returns still_from_shaken, in the camera's axes (x right, y down, z forward). A robot that stands does not shake.
  SE3 at(double time_s, double speed_mps) const;

 private:
  std::vector<Wobble> wobbles_;
};

}  // namespace rumi::synth
