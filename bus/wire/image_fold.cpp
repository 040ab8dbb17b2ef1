// SPDX-License-Identifier: BSD-3-Clause
#include "bus/wire/image_fold.h"

#include <fmt/format.h>

#include <cmath>

#include "slam/geometry/lens_fold.h"

namespace rumi {
namespace {

constexpr double kLeastOutside = 0.002;  // share of the pixels; less is not worth a note
constexpr double kMostOutside = 0.5;  // share of the pixels; above it the coefficients are wrong, or in another order

double share_beyond(const Camera& camera, double radius) {
  constexpr int kSteps = 64;
  int beyond = 0;
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < kSteps; ++j)
      beyond += is_beyond_fold(camera, radius, (i + 0.5) / kSteps * camera.width - 0.5,
                               (j + 0.5) / kSteps * camera.height - 0.5);
  return static_cast<double>(beyond) / (kSteps * kSteps);
}

std::string coefficients(const Camera& camera) {
  const std::string three = fmt::format("k1 = {:.6g}, k2 = {:.6g}, k3 = {:.6g}", camera.k1, camera.k2, camera.k3);
  return camera.model == Camera::Model::kKannalaBrandt ? fmt::format("{}, k4 = {:.6g}", three, camera.k4) : three;
}

}  // namespace

Fold fold_of(const Camera& camera) {
  const double radius = fold_radius(camera);
  const double share = std::isfinite(radius) ? share_beyond(camera, radius) : 0;
  if (share < kLeastOutside) return {};
  const std::string where = fmt::format(
      "{:.{}f} % of the image lies beyond {:.0f} px from cx, cy, where the distortion "
      "({}) folds the image",
      100 * share, share < 0.01 ? 1 : 0, radius * std::sqrt(camera.fx * camera.fy), coefficients(camera));
  if (share > kMostOutside)
    return {true, where +
                      ": look at the coefficients and their order, or calibrate again with the board in the corners "
                      "of the images, too"};
  return {false, where +
                     ", and is not used; a calibration with the board in the corners of the images would tell what is "
                     "seen there"};
}

}  // namespace rumi
