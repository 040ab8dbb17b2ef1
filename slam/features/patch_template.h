// SPDX-License-Identifier: BSD-3-Clause
// What a patch of one image should look like in another; see patch_alignment.h.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "slam/features/image_pyramid.h"

namespace rumi {

struct PatchTemplate {
  static constexpr int kRadius = 7;  // pixels of the level
  static constexpr int kRows = 2 * kRadius + 1;
  static constexpr int kColumns = kRows + 1;  // whole vectors; the last column is no part of the patch
  using Patch = std::array<float, kRows * kColumns>;

  // The least squares within a radius of the middle. Grey and slopes count without their means, the slopes also without
  // what a change of contrast explains.
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

// The patch around the pixel `reference` (of the full image) as it should appear in a level of another image whose
// pixels are pixel_size pixels of the full image large. image_from_reference: how steps of a pixel in the reference, x
// and y in the columns, appear in the image, both full. Nothing if the patch leaves the reference's image or is
// distorted beyond all measure.
std::optional<PatchTemplate> make_patch_template(const ImagePyramid& reference_images, const Eigen::Vector2f& reference,
                                                 const Eigen::Matrix2f& image_from_reference, float pixel_size);

}  // namespace rumi
