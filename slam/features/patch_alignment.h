// SPDX-License-Identifier: BSD-3-Clause
// Finds a patch of one image in another to a fraction of a pixel.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "slam/features/image_pyramid.h"
#include "slam/features/patch_template.h"

namespace rumi {

// Where a patch is looked for: a pixel of the full image, known to a few pixels of one level. The level must exist.
struct PatchPlace {
  const ImagePyramid& images;
  Eigen::Vector2f pixel;
  int level = 0;
};

// Returns the pixel (of the full image) at which the image looks like the template. It minimizes the squared
// differences in grey value, with free contrast and brightness (Baker and Matthews, "Lucas-Kanade 20 Years On", IJCV
// 2004, the inverse compositional algorithm). A weak prior holds it near at.pixel in directions that the patch does not
// determine. It tries 15 x 15 pixels of the level, then 9 x 9. Returns nullopt if neither agrees with the template, or
// if the patch moves farther than 2 pixels of the level or leaves the image.
std::optional<Eigen::Vector2f> align_patch(const PatchTemplate& reference, const PatchPlace& at);

}  // namespace rumi
