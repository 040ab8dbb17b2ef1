// SPDX-License-Identifier: BSD-3-Clause
// Describes a distortion that folds the image (slam/geometry/lens_fold.h).
#pragma once

#include <string>

#include "slam/geometry/camera.h"

namespace rumi {

struct Fold {
  bool is_too_much = false;  // the camera is of no use: more than half of the image lies beyond the fold
  std::string text;          // says which part of the image is not used, and what to do about it; empty if that part is
                             // nothing or too small to mention
};
Fold fold_of(const Camera& camera);

}  // namespace rumi
