// SPDX-License-Identifier: BSD-3-Clause
// A lens images what is farther from its axis farther from the image's centre. Coefficients that were fitted to views
// of the middle alone often say otherwise near the corners: there the distortion folds the image, and no ray belongs to
// a pixel.
#pragma once

#include "slam/geometry/camera.h"

namespace rumi {

// Distance from the principal point, in units of the focal length, from which on the radial distortion folds the image;
// infinite if it does so nowhere that matters (within 89 degrees of the axis; of a fisheye 60 degrees, as its image may
// be a circle).
double fold_radius(const Camera& camera);

// Is the pixel farther out?
inline bool is_beyond_fold(const Camera& camera, double fold_radius, double x_px, double y_px) {
  const double x = (x_px - camera.cx) / camera.fx, y = (y_px - camera.cy) / camera.fy;
  return x * x + y * y > fold_radius * fold_radius;
}

}  // namespace rumi
