// SPDX-License-Identifier: BSD-3-Clause
// A lens maps points farther from its axis farther from the image's centre. Coefficients that were fitted to the middle
// of the image alone often violate this near the corners: the distortion folds the image, and pixels there belong to no
// ray.
#pragma once

#include "slam/geometry/camera.h"

namespace rumi {

// Returns the distance from the principal point, in units of the focal length, beyond which the radial distortion folds
// the image. It is infinite if there is no fold within 89 degrees of the axis. A fisheye is examined only within 60
// degrees, because its image may be a circle, and nothing is seen outside it.
double fold_radius(const Camera& camera);

// True if the pixel lies beyond the fold.
inline bool is_beyond_fold(const Camera& camera, double fold_radius, double x_px, double y_px) {
  const double x = (x_px - camera.cx) / camera.fx, y = (y_px - camera.cy) / camera.fy;
  return x * x + y * y > fold_radius * fold_radius;
}

}  // namespace rumi
