// SPDX-License-Identifier: BSD-3-Clause
// Finds the keypoints near a place in the image without looking at all of them.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <span>
#include <vector>

#include "slam/geometry/camera.h"

namespace rumi {

class KeypointGrid {
 public:
  KeypointGrid() = default;
  // `points`: pixels of the camera. If undistorted, they may lie a little outside the image: the border cells take
  // them.
  KeypointGrid(std::span<const Eigen::Vector2f> points, const Camera& camera);

  // Calls visit(index) for every point whose cell touches the square of side 2 * radius_px around center; the caller
  // checks the distance itself.
  template <class Visit>
  void for_each_near(const Eigen::Vector2f& center, float radius_px, Visit visit) const {
    const int x0 = column(center.x() - radius_px), x1 = column(center.x() + radius_px);
    const int y0 = row(center.y() - radius_px), y1 = row(center.y() + radius_px);
    for (int y = y0; y <= y1; ++y)
      for (int i = start_[y * columns_ + x0]; i < start_[y * columns_ + x1 + 1]; ++i) visit(index_[i]);
  }

 private:
  static constexpr float kCell = 16;  // side of a cell in pixels
  int column(float x) const { return cell(x, columns_); }
  int row(float y) const { return cell(y, rows_); }
  // Clamps to the border cells; NaN gives the first. Compares floats because a large one does not fit an int.
  static int cell(float at, int count) {
    return at > 0 ? static_cast<int>(std::min(at / kCell, static_cast<float>(count - 1))) : 0;
  }
  int columns_ = 1, rows_ = 1;
  std::vector<int> start_{0, 0};  // index_[start_[cell]] is the cell's first point; the last element is the end of
                                  // index_
  std::vector<int> index_;
};

}  // namespace rumi
