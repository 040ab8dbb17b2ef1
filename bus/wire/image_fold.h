// SPDX-License-Identifier: BSD-3-Clause
// Describes a distortion that folds the image (slam/geometry/lens_fold.h).
#pragma once

#include <string>

#include "slam/geometry/camera.h"

namespace rumi {

struct Fold {
  bool is_too_much = false;  // such a camera is of no use: little of the image is left
  std::string text;          // which part of the image is not used, and what to do; empty if all of it is
};
Fold fold_of(const Camera& camera);

}  // namespace rumi
