// SPDX-License-Identifier: BSD-3-Clause
// A lens images what is farther from its axis farther from the image's centre. Coefficients that say otherwise within
// the image are wrong, in another order, or fitted to views that did not reach so far.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bus/wire/camera_file/lens.h"

namespace rumi {
namespace {

constexpr double kWidest_rad = 60 * M_PI / 180;  // a fisheye's image may be a circle, and folds outside it
constexpr double kWidestSlope = 60;              // x/z: 89 degrees
constexpr double kMostOutside = 0.03;            // of the pixels: the corners

struct Lens {
  double k1, k2, k3, k4;

  // Distance from the centre, by the distance, or angle, without distortion.
  double distorted(double r) const {
    const double r2 = r * r;
    return r * (1 + r2 * (k1 + r2 * (k2 + r2 * (k3 + r2 * k4))));
  }
  double slope(double r) const {
    const double r2 = r * r;
    return 1 + r2 * (3 * k1 + r2 * (5 * k2 + r2 * (7 * k3 + r2 * 9 * k4)));
  }
};

// The part of the pixels that is farther from the centre than this.
double share_outside(const Camera& camera, double radius) {
  constexpr int kSteps = 64;
  int outside = 0;
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < kSteps; ++j) {
      const double x = (i + 0.5) / kSteps * camera.width - 0.5, y = (j + 0.5) / kSteps * camera.height - 0.5;
      outside += std::hypot((x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy) > radius;
    }
  return static_cast<double>(outside) / (kSteps * kSteps);
}

}  // namespace

std::string fold_of(const Camera& camera) {
  const bool fisheye = camera.model == Camera::Model::kKannalaBrandt;
  const Lens lens{camera.k1, camera.k2, camera.k3, fisheye ? camera.k4 : 0};
  const double end = fisheye ? kWidest_rad : kWidestSlope;
  double turn = 0.001;
  while (turn < end && lens.slope(turn) > 0) turn *= 1.002;
  if (turn >= end) return "";
  const double radius = lens.distorted(turn), outside = share_outside(camera, radius);
  if (outside <= kMostOutside) return "";
  return fmt::format(
      "the distortion folds the image: with {} nothing is imaged farther than {:.0f} pixels from cx, cy, and {:.0f} % "
      "of the image is farther; look at the coefficients and their order, or calibrate again with the board in the "
      "corners of the images, too",
      fisheye ? fmt::format("k1 = {:.6g}, k2 = {:.6g}, k3 = {:.6g}, k4 = {:.6g}", camera.k1, camera.k2, camera.k3,
                            camera.k4)
              : fmt::format("k1 = {:.6g}, k2 = {:.6g}, k3 = {:.6g}", camera.k1, camera.k2, camera.k3),
      std::max(0.0, radius) * std::sqrt(camera.fx * camera.fy), 100 * outside);
}

}  // namespace rumi
