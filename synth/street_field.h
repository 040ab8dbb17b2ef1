// SPDX-License-Identifier: BSD-3-Clause
// The ground around a route as a grid: its height, how far the route is, and what has been built where.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "base/result.h"
#include "synth/street_route.h"

namespace rumi::synth {

// A rectangle on the ground. `along` and `inward` are unit vectors at right angles.
struct Footprint {
  Eigen::Vector2d corner, along, inward;
  double width_m, depth_m;

  Eigen::Vector2d at(double along_m, double inward_m) const { return corner + along_m * along + inward_m * inward; }
};

class StreetField {
 public:
  static constexpr double kReach_m = 44;           // distances are known up to this
  static constexpr double kCell_m = 2;             // cells of the ground's triangles
  static constexpr double kCameraHeight_m = 1.65;  // the ground is lower than the path's camera by this

  // An Error says what is wrong with a path for a street.
  static Result<> check(const Route& route);
  explicit StreetField(const Route& route);

  // Returns the distance to the nearest part of the route, kReach_m at most.
  double distance_m(const Eigen::Vector2d& at) const;
  // Returns the height of the road there, on the triangles that the ground is drawn with.
  double ground_m(const Eigen::Vector2d& at) const;
  Eigen::Vector2d low() const { return low_; }
  Eigen::Vector2d high() const { return low_ + kCell_m * Eigen::Vector2d(columns_, rows_); }
  int columns() const { return columns_; }  // cells of the ground
  int rows() const { return rows_; }

  // Returns whether no part of a footprint is nearer to the route than `clear_m`, and none has been built on.
  bool is_free(const Footprint& footprint, double clear_m) const;
  bool is_free(const Eigen::Vector2d& at, double radius_m) const;
  void build(const Footprint& footprint);
  void build(const Eigen::Vector2d& at, double radius_m);

 private:
  void measure(const Route& route);
  void smooth_ground(const Route& route);
  cv::Point built_cell(const Eigen::Vector2d& at) const;

  Eigen::Vector2d low_;
  int columns_ = 0, rows_ = 0;
  cv::Mat distance_;  // CV_32F, one value a metre
  cv::Mat ground_;    // CV_32F, one value for each corner of a cell
  cv::Mat built_;     // CV_8U, cells of half a metre
};

}  // namespace rumi::synth
