// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/model/point_cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "slam/numeric/median.h"

namespace rumi::map_server {
namespace {

constexpr double kCellsPerReach = 8;
constexpr double kSlack = 1 + 1e-9;  // so that rounding loses no point

// Returns the angle between the optical axis and the image corner farthest from it.
double half_field_rad(const Camera& camera) {
  double widest = 0;
  for (double u : {0, camera.width})
    for (double v : {0, camera.height})
      widest = std::max(widest, std::hypot((u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy));
  return std::atan(widest);
}

bool may_see(const Eigen::Vector3d& center_in_cam, double radius, double half_field) {
  const double distance = center_in_cam.norm();
  if (distance <= radius) return true;
  const double off_axis = std::acos(std::clamp(center_in_cam.z() / distance, -1.0, 1.0));
  return off_axis <= (half_field + std::asin(radius / distance)) * kSlack + 1e-9;
}

}  // namespace

PointCells::PointCells(const std::vector<MapModel::Point>& points, const std::vector<double>& reach) {
  std::vector<double> reaches;
  for (double r : reach)
    if (std::isfinite(r) && r > 0) reaches.push_back(r);
  if (reaches.empty()) return;
  const double side = median(&reaches) / kCellsPerReach;
  std::map<std::array<double, 3>, size_t> cell_at;
  for (size_t p = 0; p < points.size(); ++p) {
    const Eigen::Vector3d& position = points[p].position;
    if (!position.allFinite() || !(reach[p] > 0)) continue;
    const Eigen::Vector3d corner = (position / side).array().floor();
    const auto [at, is_new] = cell_at.try_emplace({corner.x(), corner.y(), corner.z()}, cells_.size());
    if (is_new) {
      cells_.emplace_back();
      cells_.back().center = position;
    }
    Cell& cell = cells_[at->second];
    cell.radius = std::max(cell.radius, (position - cell.center).norm());
    cell.reach = std::max(cell.reach, reach[p]);
    cell.points.push_back(static_cast<int>(p));
  }
}

std::vector<int> PointCells::may_be_seen(const MapModel::View& view) const {
  const double half_field = half_field_rad(view.camera);
  const Eigen::Vector3d center = view.cam_from_map.center();
  std::vector<int> points;
  for (const Cell& cell : cells_) {
    if ((cell.center - center).norm() > (cell.radius + cell.reach) * kSlack) continue;
    if (!may_see(view.cam_from_map * cell.center, cell.radius, half_field)) continue;
    points.insert(points.end(), cell.points.begin(), cell.points.end());
  }
  std::sort(points.begin(), points.end());
  return points;
}

}  // namespace rumi::map_server
