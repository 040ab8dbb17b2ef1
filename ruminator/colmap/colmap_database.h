// SPDX-License-Identifier: BSD-3-Clause
// Writes COLMAP's database.db (3.8, user_version 3800; later versions bring it up to date when they open it) with our
// keypoints and verified matches, so that only COLMAP's `mapper` has to run. The keypoints are undistorted and the
// camera is a PINHOLE one: so every lens model we know works, k3 and fisheye included, and the mapper can refine
// nothing but the focal lengths.
#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "ruminator/matching/window_image.h"
#include "slam/geometry/camera.h"

namespace rumi::ruminator {

// Replaces the file. COLMAP's image ids are index + 1. An Error has the file and the reason.
Result<> write_colmap_database(const std::string& file, const Camera& camera, const std::vector<WindowImage>& images,
                               const std::vector<ImagePair>& pairs);

}  // namespace rumi::ruminator
