// SPDX-License-Identifier: BSD-3-Clause
// The sizes in which an image is searched for keypoints. An octave means a size only together with its pyramid.
#pragma once

#include <vector>

namespace rumi {

struct Pyramid {
  static constexpr int kMostLevels = 16;
  static constexpr double kLeastFactor = 1.05, kMostFactor = 2.5;

  int levels = 8;             // octaves 0 ... levels - 1; 0 is the full image
  double scale_factor = 1.2;  // ratio of a level's pixel size to that of the level before

  bool is_possible() const {
    return levels >= 1 && levels <= kMostLevels && scale_factor >= kLeastFactor && scale_factor <= kMostFactor;
  }
  // Returns the size of a level's pixels in pixels of the full image, which is also taken for the standard deviation of
  // its keypoints.
  double scale(int octave) const {
    double scale = 1;
    for (int i = 0; i < octave; ++i) scale *= scale_factor;
    return scale;
  }
  std::vector<double> scales() const {  // scale() by octave
    std::vector<double> scales(levels);
    for (int i = 0; i < levels; ++i) scales[i] = scale(i);
    return scales;
  }
  bool operator==(const Pyramid&) const = default;
};

}  // namespace rumi
