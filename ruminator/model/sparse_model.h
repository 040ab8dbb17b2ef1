// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <map>
#include <utility>
#include <vector>

#include "slam/geometry/transform.h"

namespace rumi::ruminator {

struct SparseModel {
  struct Point {
    Eigen::Vector3d position;
    std::vector<std::pair<int, int>> track;  // (image index, keypoint index) of write_colmap_database()
  };
  double fx = 0, fy = 0;              // pixels; of COLMAP's camera, which is not refined
  std::map<int, SE3> cam_from_world;  // registered images, by index (COLMAP's id - 1)
  std::vector<Point> points;          // points in order of COLMAP's ids
};

}  // namespace rumi::ruminator
