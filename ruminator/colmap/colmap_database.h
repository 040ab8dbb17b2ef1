// SPDX-License-Identifier: BSD-3-Clause
// Writes COLMAP's database.db (3.8, user_version 3800; later versions bring it up to date when they open it) with our
// keypoints and verified matches, so that of COLMAP only `mapper` has to run. Keypoints go in undistorted with a
// PINHOLE camera: every lens model we know works, k3 and fisheye included, and the focal lengths are all that the
// mapper can refine.
#pragma once

#include <string>
#include <vector>

#include "ruminator/matching/window_image.h"
#include "slam/geometry/camera.h"

namespace rumi::ruminator {

// Replaces the file. COLMAP's image ids are index + 1. Returns what went wrong (file, reason), or an empty string.
std::string write_colmap_database(const std::string& file, const Camera& camera, const std::vector<WindowImage>& images,
                                  const std::vector<ImagePair>& pairs);

}  // namespace rumi::ruminator
