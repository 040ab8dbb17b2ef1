// SPDX-License-Identifier: BSD-3-Clause
// The sizes of an image in which keypoints are looked for. Octaves tell sizes only together with it.
#pragma once

#include <vector>

namespace rumi {

struct Pyramid {
  static constexpr int kMostLevels = 16;
  static constexpr double kLeastFactor = 1.05, kMostFactor = 2.5;

  int levels = 8;             // octaves 0 ... levels - 1; 0 is the full image
  double scale_factor = 1.2;  // of a level's pixels to those of the level below

  bool is_possible() const {
    return levels >= 1 && levels <= kMostLevels && scale_factor >= kLeastFactor && scale_factor <= kMostFactor;
  }
  // Size of a level's pixels in pixels of the full image: the standard deviation of a keypoint there, too.
  double scale(int octave) const {
    double scale = 1;
    for (int i = 0; i < octave; ++i) scale *= scale_factor;
    return scale;
  }
  std::vector<double> scales() const {  // of all levels
    std::vector<double> scales(levels);
    for (int i = 0; i < levels; ++i) scales[i] = scale(i);
    return scales;
  }
  bool operator==(const Pyramid&) const = default;
};

}  // namespace rumi
