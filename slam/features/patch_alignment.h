// SPDX-License-Identifier: BSD-3-Clause
// Sub-pixel place of a patch of one image in another.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "slam/features/image_pyramid.h"

namespace rumi {

// Where a patch is looked for: a pixel of the full image, known to within a few pixels of one of the image's levels.
struct PatchPlace {
  const ImagePyramid& images;
  Eigen::Vector2f pixel;
  int level = 0;
};

// The pixel (of the full image) at which `at` looks as the pixel `reference` of another image does: by least squares of
// the differences in grey value, contrast and brightness being free (Baker and Matthews, "Lucas-Kanade 20 Years On",
// IJCV 2004, the inverse compositional algorithm), held near at.pixel in as far as the patch does not tell.
// image_from_reference: how steps of a pixel in the reference, x and y in the columns, appear in the image, both full.
// Looks at 15 x 15 pixels of the level, or at 9 x 9 where these do not agree. Nothing if neither does, moves farther
// than 2 pixels of the level, or leaves an image.
std::optional<Eigen::Vector2f> align_patch(const ImagePyramid& reference_images, const Eigen::Vector2f& reference,
                                           const Eigen::Matrix2f& image_from_reference, const PatchPlace& at);

}  // namespace rumi
