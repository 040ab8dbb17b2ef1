// SPDX-License-Identifier: BSD-3-Clause
// Finds a patch of one image in another to a fraction of a pixel.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "slam/features/image_pyramid.h"
#include "slam/features/patch_template.h"

namespace rumi {

// Where to look for a patch: a pixel of the full image, wrong by at most 2 pixels of the level. The level must exist.
struct PatchPlace {
  const ImagePyramid& images;
  Eigen::Vector2f pixel;
  int level = 0;
};

// Returns the pixel of the full image at which the image looks like the template, or nullopt if neither 15 x 15 nor
// then 9 x 9 pixels of the level agree with the template. A patch may move by up to 2 pixels of the level and must not
// leave the image. The squared differences in grey value are minimized, with free contrast and brightness (Baker and
// Matthews, "Lucas-Kanade 20 Years On", IJCV 2004, the inverse compositional algorithm). A weak prior keeps the pixel
// near at.pixel in directions that the patch does not determine.
std::optional<Eigen::Vector2f> align_patch(const PatchTemplate& reference, const PatchPlace& at);

}  // namespace rumi
