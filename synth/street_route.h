// SPDX-License-Identifier: BSD-3-Clause
// The camera's way on the ground, by its length. Street axes: those of the map, turned so that z is up; metres.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "synth/camera_path.h"

namespace rumi::synth {

// Returns the rotation that turns the path's "up" to z.
SE3 street_from_map(const CameraPath& path);

class Route {
 public:
  Route(const CameraPath& path, const SE3& street_from_map);

  double length_m() const { return static_cast<double>(points_.size() - 1); }
  // Returns how long the way from the beginning of the path is at that time.
  double way_m(double time_s) const;
  // Returns the place on the way, its direction (a unit vector), and a place beside it. Beyond the ends the way goes on
  // straight.
  Eigen::Vector2d at(double way_m) const;
  Eigen::Vector2d ahead(double way_m) const;
  Eigen::Vector2d beside(double way_m, double left_m) const;
  // Returns the points of the way, one every metre, with the camera's height.
  const std::vector<Eigen::Vector3d>& points() const { return points_; }

 private:
  std::vector<double> times_s_, ways_m_;  // the camera's progress
  std::vector<Eigen::Vector3d> points_;
};

}  // namespace rumi::synth
