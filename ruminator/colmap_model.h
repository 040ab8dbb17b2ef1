// SPDX-License-Identifier: BSD-3-Clause
// Reads the sparse models that COLMAP's mapper leaves (cameras.bin, images.bin, points3D.bin).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "slam/geometry/transform.h"

namespace rumi {

struct ColmapModel {
  struct Point {
    Eigen::Vector3d position;
    std::vector<std::pair<int, int>> track;  // (image index, keypoint index) as given to write_colmap_database
  };
  double fx = 0, fy = 0;              // as refined or as given, pixels
  std::map<int, SE3> cam_from_world;  // of the registered images, by index (COLMAP's id - 1)
  std::vector<Point> points;          // in order of COLMAP's ids
};

struct ColmapModelFile {
  ColmapModel model;
  std::string error;  // empty, or the file, what is wrong and where
  bool ok() const { return error.empty(); }
};

// Every count, index and number in the files is checked: images and keypoints as in `keypoint_counts` (per image),
// finite values, positive focal lengths. A truncated or corrupt file is an error.
ColmapModelFile read_colmap_model(const std::string& folder, const std::vector<int>& keypoint_counts);
// The folders 0, 1, 2, ... that the mapper made under `folder`, in order.
std::vector<std::string> colmap_model_folders(const std::string& folder);

}  // namespace rumi
