// SPDX-License-Identifier: BSD-3-Clause
// Writes COLMAP's database.db (3.8, user_version 3800) with our keypoints and verified matches, so that of COLMAP only
// `mapper` has to run. Keypoints go in undistorted with a PINHOLE camera: every lens model we know works, k3 and
// fisheye included, and the focal lengths are all that the mapper can refine.
#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "slam/geometry/camera.h"

namespace rumi {

struct ColmapImage {
  std::string name;                        // unique
  std::vector<Eigen::Vector2f> keypoints;  // undistorted pixels, (0, 0) = centre of the upper-left pixel
};

struct ColmapPair {
  int first = 0, second = 0;                 // indices into the images
  std::vector<std::pair<int, int>> matches;  // keypoint indices; verified
};

// Replaces the file. COLMAP's image ids are index + 1. Returns what went wrong (file, reason), or an empty string.
std::string write_colmap_database(const std::string& file, const Camera& camera, const std::vector<ColmapImage>& images,
                                  const std::vector<ColmapPair>& pairs);

}  // namespace rumi
