// SPDX-License-Identifier: BSD-3-Clause
#include "slam/map/pose_sigmas.h"

namespace rumi {
namespace {

constexpr double kLargest = 1e6;

// Returns false for NaN, too.
bool is_deviation(float value) { return value > 0 && value <= static_cast<float>(kLargest); }

}  // namespace

PoseSigmas pose_sigmas(double position, double rotation_rad, double log_scale) {
  const auto fits = [](double value) { return value >= 0 && value <= kLargest; };  // can be converted to float
  if (!fits(position) || !fits(rotation_rad) || !fits(log_scale)) return {};
  const PoseSigmas sigmas{static_cast<float>(position), static_cast<float>(rotation_rad),
                          static_cast<float>(log_scale)};
  return is_deviation(sigmas.position) && is_deviation(sigmas.rotation_rad) ? sigmas : PoseSigmas();
}

PoseSigmas scaled(const PoseSigmas& sigmas, double scale) {
  if (!sigmas.are_known()) return {};
  return pose_sigmas(scale * static_cast<double>(sigmas.position), static_cast<double>(sigmas.rotation_rad),
                     static_cast<double>(sigmas.log_scale));
}

}  // namespace rumi
