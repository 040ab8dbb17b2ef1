// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace rumi {

// Radial distortion: an odd polynomial that maps the distance r from the axis to the distorted distance. For a pinhole
// camera r is the length of (x/z, y/z), and k4 is 0; for a fisheye r is the angle to the axis.
struct RadialDistortion {
  double k1, k2, k3, k4;

  double distorted(double r) const {
    const double r2 = r * r;
    return r * (1 + r2 * (k1 + r2 * (k2 + r2 * (k3 + r2 * k4))));
  }
  double slope(double r) const {
    const double r2 = r * r;
    return 1 + r2 * (3 * k1 + r2 * (5 * k2 + r2 * (7 * k3 + r2 * 9 * k4)));
  }
};

}  // namespace rumi
