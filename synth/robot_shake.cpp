// SPDX-License-Identifier: BSD-3-Clause
#include "synth/robot_shake.h"

#include <algorithm>

#include "synth/street_style.h"

namespace rumi::synth {
namespace {

constexpr double kPitch_rad = 0.011, kRoll_rad = 0.013, kYaw_rad = 0.004, kBounce_m = 0.007;
constexpr double kFullSpeed_mps = 0.8;  // from here on it shakes no more

}  // namespace

RobotShake::RobotShake(uint64_t seed) {
  cv::RNG rng = rng_of(seed, kShakeChance, 0);
  for (int i = 0; i < 4; ++i) wobbles_.emplace_back(rng, std::vector<double>{0.7, 1.9, 4.3, 7.1});
}

SE3 RobotShake::at(double time_s, double speed_mps) const {
  const double amount = std::clamp(speed_mps / kFullSpeed_mps, 0.0, 1.0);
  const auto turn = [&](size_t wobble, double most, const Eigen::Vector3d& axis) {
    return Eigen::AngleAxisd(amount * most * wobbles_[wobble].at(time_s), axis);
  };
  const Eigen::Quaterniond rotation(turn(0, kPitch_rad, Eigen::Vector3d::UnitX()) *
                                    turn(1, kYaw_rad, Eigen::Vector3d::UnitY()) *
                                    turn(2, kRoll_rad, Eigen::Vector3d::UnitZ()));
  return {rotation, {0, amount * kBounce_m * wobbles_[3].at(time_s), 0}};
}

}  // namespace rumi::synth
