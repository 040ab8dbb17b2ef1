// SPDX-License-Identifier: BSD-3-Clause
// Sorts the points of the map into cells, so that a view need not test each point.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "map_server/model/map_model.h"

namespace rumi::map_server {

class PointCells {
 public:
  PointCells() = default;
  // `reach`: for each point, the largest distance at which it can be seen. Points that are not finite or have no reach
  // are left out.
  PointCells(const std::vector<MapModel::Point>& points, const std::vector<double>& reach);

  // Returns the indices, ascending, of all points in the view's field of view and within their reach, and of some
  // others near them.
  std::vector<int> may_be_seen(const MapModel::View& view) const;

 private:
  // A ball, and the points in it.
  struct Cell {
    Eigen::Vector3d center = Eigen::Vector3d::Zero();
    double radius = 0, reach = 0;
    std::vector<int> points;
  };
  std::vector<Cell> cells_;
};

}  // namespace rumi::map_server
