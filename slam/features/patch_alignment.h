// SPDX-License-Identifier: BSD-3-Clause
// Sub-pixel place of a patch of one image in another.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "slam/features/image_pyramid.h"
#include "slam/features/patch_template.h"

namespace rumi {

// Where a patch is looked for: a pixel of the full image, known to within a few pixels of one of the image's levels,
// which must exist.
struct PatchPlace {
  const ImagePyramid& images;
  Eigen::Vector2f pixel;
  int level = 0;
};

// The pixel (of the full image) at which the image looks as the template does: by least squares of the differences in
// grey value, contrast and brightness being free (Baker and Matthews, "Lucas-Kanade 20 Years On", IJCV 2004, the
// inverse compositional algorithm), held near at.pixel in as far as the patch does not tell. Looks at 15 x 15 pixels of
// the level, or at 9 x 9 where these do not agree. Nothing if neither does, moves farther than 2 pixels of the level,
// or leaves the image.
std::optional<Eigen::Vector2f> align_patch(const PatchTemplate& reference, const PatchPlace& at);

}  // namespace rumi
