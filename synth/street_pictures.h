// SPDX-License-Identifier: BSD-3-Clause
// Paints the surfaces of a street. Pictures have two channels as in painter.h. In a picture with holes, the second one
// is 255 where there is a hole.
#pragma once

#include "synth/painter.h"
#include "synth/texture_atlas.h"

namespace rumi::synth {

// Ground, of one layer of the atlas, which fits to itself on all sides.
inline constexpr double kGroundPxPerM = 100;
cv::Mat paint_asphalt(cv::RNG& rng);
cv::Mat paint_paving(cv::RNG& rng);
cv::Mat paint_lawn(cv::RNG& rng);

struct Facade {
  double width_m, height_m;
  int storeys;
  bool door, shop;
};
cv::Mat paint_facade(const Facade& facade, double px_per_m, cv::RNG& rng);
Palette facade_palette(cv::RNG& rng);
cv::Mat paint_roof(cv::Size size, double px_per_m, cv::RNG& rng);
Palette roof_palette(cv::RNG& rng);

cv::Mat paint_leaves(cv::RNG& rng);  // with holes
cv::Mat paint_fence(cv::RNG& rng);   // with holes
cv::Mat paint_hedge(cv::RNG& rng);
cv::Mat paint_sign(cv::RNG& rng);
cv::Mat paint_manhole(cv::RNG& rng);
cv::Mat paint_patch_of_tar(cv::RNG& rng);
cv::Mat paint_marking(cv::RNG& rng);  // with holes, where it is worn

// The outline of a car as seen from its right side, from its rear to its front: x along it from its middle, z up, m.
struct CarShape {
  std::vector<cv::Point2d> outline;  // from the lower rear over the roof to the lower front
  double half_width_m;
  double axles_m[2];  // x of the rear and the front one
  double length_m, height_m;
};
CarShape car_shape(int kind);  // 0: hatchback, 1: saloon, 2: van, 3: estate car
inline constexpr int kCarShapes = 4;
inline constexpr double kCarPxPerM = 90;
cv::Mat paint_car_side(const CarShape& shape, cv::RNG& rng);
cv::Mat paint_car_end(bool rear, cv::RNG& rng);
cv::Mat paint_glass(cv::RNG& rng);
cv::Mat paint_wheel(cv::RNG& rng);
Palette car_palette(cv::RNG& rng);

cv::Mat paint_lorry(cv::Size2d size_m, bool back, cv::RNG& rng);
cv::Mat paint_sky(double clouds, cv::RNG& rng);  // all around: from the horizon below to kSkyTop_rad above it

inline constexpr double kSkyTop_rad = 1.2, kSkyBottom_rad = -0.06;

}  // namespace rumi::synth
