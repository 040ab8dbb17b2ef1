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
  static constexpr int kColumns = kRows + 1;  // a whole number of vectors; the last column is not part of the patch
  using Patch = std::array<float, kRows * kColumns>;

  // The least-squares terms of the pixels within a radius. Grey values and slopes have zero mean; the slopes also have
  // the part removed that a change of contrast explains.
  struct Fit {
    int radius = 0;
    bool usable = false;  // false: too little contrast
    float mean_grey = 0, mean_x = 0, mean_y = 0;
    float explained_x = 0, explained_y = 0;  // slope per grey
    float norm2 = 0;                         // sum of the squares of grey
    Eigen::Matrix2f information;             // sums of the products of the slopes
    float pixels() const { return static_cast<float>((2 * radius + 1) * (2 * radius + 1)); }
  };

  Patch grey, slope_x, slope_y;
  std::array<Fit, 2> fits;  // the larger radius first
};

// Returns the patch around the pixel `reference` (of the full image) as it should appear in a level of another image.
// `pixel_size`: size of the level's pixels in pixels of its full image. `image_from_reference`: the columns say how
// steps of one pixel in x and y of the reference appear in the other image, both in full size. Returns nullopt if the
// patch leaves the reference's image or is distorted too much.
std::optional<PatchTemplate> make_patch_template(const ImagePyramid& reference_images, const Eigen::Vector2f& reference,
                                                 const Eigen::Matrix2f& image_from_reference, float pixel_size);

}  // namespace rumi
