// SPDX-License-Identifier: BSD-3-Clause
// The expected appearance of a patch of one image in another; see patch_alignment.h.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "slam/features/image_pyramid.h"

namespace rumi {

struct PatchTemplate {
  static constexpr int kRadius = 7;  // pixels of the level
  static constexpr int kRows = 2 * kRadius + 1;
  static constexpr int kColumns = kRows + 1;  // rounded up to whole vectors; the last column is not part of the patch
  using Patch = std::array<float, kRows * kColumns>;

  // The least-squares terms of the pixels within a radius. norm2 and information are sums of deviations from the means;
  // the slopes in information also lack the part that a change of contrast explains.
  struct Fit {
    int radius = 0;
    bool usable = false;  // false if the contrast is too low
    float mean_grey = 0, mean_x = 0, mean_y = 0;
    float explained_x = 0, explained_y = 0;  // part of a slope that a change of contrast explains, per grey level
    float norm2 = 0;                         // sum of squared deviations of the grey values
    Eigen::Matrix2f information;             // sums of the products of the slopes
    float pixels() const { return static_cast<float>((2 * radius + 1) * (2 * radius + 1)); }
  };

  Patch grey, slope_x, slope_y;
  std::array<Fit, 2> fits;  // the larger radius first
};

// Returns the patch around the pixel `reference` (of the full image) as it should appear in a level of another image.
// `pixel_size`: size of that level's pixels, in pixels of its full image. `image_from_reference`: its columns are the
// steps in the other image for steps of one pixel in x and y of the reference, both in full size. Returns nullopt if
// the patch leaves the reference's image or is distorted too much.
std::optional<PatchTemplate> make_patch_template(const ImagePyramid& reference_images, const Eigen::Vector2f& reference,
                                                 const Eigen::Matrix2f& image_from_reference, float pixel_size);

}  // namespace rumi
