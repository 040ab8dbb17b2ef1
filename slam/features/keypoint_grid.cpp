// SPDX-License-Identifier: BSD-3-Clause
#include "slam/features/keypoint_grid.h"

namespace rumi {

KeypointGrid::KeypointGrid(std::span<const Eigen::Vector2f> points, const Camera& camera)
    : columns_(static_cast<int>(static_cast<float>(camera.width) / kCell) + 1),
      rows_(static_cast<int>(static_cast<float>(camera.height) / kCell) + 1) {
  const size_t cells = static_cast<size_t>(columns_) * rows_;
  start_.assign(cells + 1, 0);
  std::vector<int> cell(points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    cell[i] = row(points[i].y()) * columns_ + column(points[i].x());
    ++start_[cell[i] + 1];
  }
  for (size_t c = 0; c < cells; ++c) start_[c + 1] += start_[c];
  index_.resize(points.size());
  std::vector<int> next(start_.begin(), start_.end() - 1);
  for (size_t i = 0; i < points.size(); ++i) index_[next[cell[i]]++] = static_cast<int>(i);
}

}  // namespace rumi
