// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

namespace rumi::ruminator {

struct WindowImage {
  std::string name;                        // unique name of the image
  std::vector<Eigen::Vector2f> keypoints;  // undistorted pixels; (0, 0) is the centre of the upper-left pixel
};

struct ImagePair {
  int first = 0, second = 0;                 // indices into the images
  std::vector<std::pair<int, int>> matches;  // pairs of keypoint indices; verified
};

}  // namespace rumi::ruminator
