// SPDX-License-Identifier: BSD-3-Clause
// Words for a distortion that folds the image (slam/geometry/lens_fold.h).
#pragma once

#include <string>

#include "slam/geometry/camera.h"

namespace rumi {

struct Fold {
  std::string problem;  // why such a camera is of no use: little of the image is left
  std::string note;     // which part of the image is not used
};
Fold fold_of(const Camera& camera);

}  // namespace rumi
