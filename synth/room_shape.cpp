// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "synth/room.h"

namespace rumi::synth {

using Eigen::Vector3d;

std::vector<Box> RoomShape::rooms() const {
  if (repeats || !doorway) return {{low, high}};
  const double half_wall_m = doorway->wall_m / 2;
  std::vector<Box> rooms{{low, high}, {low, high}};
  rooms[0].high.x() = doorway->at.x() - half_wall_m;
  rooms[1].low.x() = doorway->at.x() + half_wall_m;
  return rooms;
}

RoomShape fit_room(const CameraPath& path, uint64_t seed, const std::optional<Doorway>& doorway) {
  RoomShape shape;
  shape.doorway = doorway;
  const Eigen::Quaterniond upright = shortest_turn(path.up(), Vector3d::UnitZ());
  // Points about 5 cm apart are enough to keep furniture away from the path.
  const double begin = path.times_s().front(), end = path.times_s().back();
  const int samples = std::clamp(static_cast<int>(path.times_s().size()), 2, 1500);
  std::vector<cv::Point2f> ground;
  for (int i = 0; i < samples; ++i) {
    shape.path.push_back(upright * path.at(begin + (end - begin) * i / (samples - 1)).translation);
    ground.emplace_back(static_cast<float>(shape.path.back().x()), static_cast<float>(shape.path.back().y()));
  }
  const double angle = doorway ? 0 : cv::minAreaRect(ground).angle * M_PI / 180;
  const Eigen::Quaterniond turn = so3_exp({0, 0, -angle});
  shape.room_from_map = SE3(turn * upright, Vector3d::Zero());
  shape.low.setConstant(1e9);
  shape.high.setConstant(-1e9);
  for (Vector3d& p : shape.path) {
    p = turn * p;
    shape.low = shape.low.cwiseMin(p);
    shape.high = shape.high.cwiseMax(p);
  }
  cv::RNG rng(seed * 31 + 5);
  for (int axis = 0; axis < 2; ++axis) {
    shape.low[axis] -= rng.uniform(1.3, 2.0);
    shape.high[axis] += rng.uniform(1.3, 2.0);
    const double missing = 4.0 - (shape.high[axis] - shape.low[axis]);
    if (missing > 0) {
      shape.low[axis] -= missing / 2;
      shape.high[axis] += missing / 2;
    }
  }
  shape.low.z() -= 1.35;
  shape.high.z() += 1.0;
  return shape;
}

RoomShape fit_cell(const CameraPath& path, const Repeats& repeats, const std::optional<Doorway>& doorway) {
  RoomShape shape;
  shape.low = repeats.cell.low;
  shape.high = repeats.cell.high;
  shape.doorway = doorway;
  shape.repeats = repeats;
  for (const SE3& map_from_cell : repeats.copies)
    for (size_t i = 0; i < path.times_s().size(); i += 10)
      shape.path.push_back(map_from_cell.inverse() * path.at(path.times_s()[i]).translation);
  return shape;
}

}  // namespace rumi::synth
