// SPDX-License-Identifier: BSD-3-Clause
// The points of the map by where they are, so that a view need not look at all of them.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "map_server/model/map_model.h"

namespace rumi::map_server {

class PointCells {
 public:
  PointCells() = default;
  // `reach`: per point, from how far it can be seen at most. Points that are not finite, or of no reach, are left out.
  PointCells(const std::vector<MapModel::Point>& points, const std::vector<double>& reach);

  // Indices, ascending, of all points that lie in the view's field of view and within their reach, and of some others.
  std::vector<int> may_be_seen(const MapModel::View& view) const;

 private:
  // All within a ball.
  struct Cell {
    Eigen::Vector3d center = Eigen::Vector3d::Zero();
    double radius = 0, reach = 0;
    std::vector<int> points;
  };
  std::vector<Cell> cells_;
};

}  // namespace rumi::map_server
