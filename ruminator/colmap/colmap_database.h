// SPDX-License-Identifier: BSD-3-Clause
// Writes COLMAP's database.db (3.8, user_version 3800; later versions migrate it when they open it) with our keypoints
// and verified matches, so that only COLMAP's `mapper` has to run. The keypoints are undistorted and the camera is a
// PINHOLE camera. Therefore every lens model that Rumi knows works, k3 and fisheye included. The mapper could refine
// the focal lengths, but its options forbid that (colmap_dialect.cpp).
#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "ruminator/matching/window_image.h"
#include "slam/geometry/camera.h"

namespace rumi::ruminator {

// Replaces the file. COLMAP's id of an image is its index + 1. An Error has the file and the reason.
Result<> write_colmap_database(const std::string& file, const Camera& camera, const std::vector<WindowImage>& images,
                               const std::vector<ImagePair>& pairs);

}  // namespace rumi::ruminator
