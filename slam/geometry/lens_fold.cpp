// SPDX-License-Identifier: BSD-3-Clause
#include "slam/geometry/lens_fold.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "slam/geometry/radial_distortion.h"

namespace rumi {
namespace {

constexpr double kWidest_rad = 60 * M_PI / 180;
constexpr double kWidestSlope = 60;  // x/z at 89 degrees from the axis

}  // namespace

double fold_radius(const Camera& camera) {
  const bool is_fisheye = camera.model == Camera::Model::kKannalaBrandt;
  const RadialDistortion lens{camera.k1, camera.k2, camera.k3, is_fisheye ? camera.k4 : 0};
  const double end = is_fisheye ? kWidest_rad : kWidestSlope;
  double turn = 0.001;
  while (turn < end && lens.slope(turn) > 0) turn *= 1.002;
  return turn < end ? std::max(0.0, lens.distorted(turn)) : std::numeric_limits<double>::infinity();
}

}  // namespace rumi
