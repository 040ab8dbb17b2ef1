// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slam/features/image_mask.h"
#include "slam/geometry/camera.h"

namespace rumi {

// Of the camera's size. Leaves out the pixels beyond the fold of its distortion (slam/geometry/lens_fold.h): what is
// seen there cannot be told.
ImageMask lens_mask(const Camera& camera);

}  // namespace rumi
