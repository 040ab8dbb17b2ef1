// SPDX-License-Identifier: BSD-3-Clause
#include "synth/handheld.h"

#include <cmath>
#include <utility>

namespace rumi::synth {

Wobble::Wobble(cv::RNG& rng, std::vector<double> frequencies_hz) : frequencies_hz_(std::move(frequencies_hz)) {
  for (size_t i = 0; i < frequencies_hz_.size(); ++i) phases_.push_back(rng.uniform(0.0, 2 * M_PI));
}

double Wobble::at(double t) const {
  double sum = 0;
  for (size_t i = 0; i < phases_.size(); ++i) sum += std::sin(2 * M_PI * frequencies_hz_[i] * t + phases_[i]);
  return sum / static_cast<double>(phases_.size());
}

SE3 look(const Eigen::Vector3d& position, double yaw_rad, double pitch_rad, double roll_rad) {
  const Eigen::Vector3d forward(std::cos(yaw_rad) * std::cos(pitch_rad), std::sin(yaw_rad) * std::cos(pitch_rad),
                                std::sin(pitch_rad));
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
  Eigen::Matrix3d r;
  r << right, forward.cross(right), forward;
  return SE3(Eigen::Matrix3d(r * Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix()), position);
}

}  // namespace rumi::synth
