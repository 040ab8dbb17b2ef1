// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slam/features/image_mask.h"
#include "slam/geometry/camera.h"

namespace rumi {

// Returns a mask of the camera's size. It leaves out the pixels beyond the fold of the distortion
// (slam/geometry/lens_fold.h), which belong to no ray.
ImageMask lens_mask(const Camera& camera);

}  // namespace rumi
