// SPDX-License-Identifier: BSD-3-Clause
// How well views of a board cover the image, and the board from all sides, as a calibration needs it.
#pragma once

#include <opencv2/core/types.hpp>
#include <string>
#include <vector>

#include "rumi/calibration/board_detector.h"

namespace rumi::tool {

// The pose of a board in an image, described without knowing the camera.
struct ViewShape {
  double x = 0, y = 0;  // the middle of its corners, parts of the image's width and height
  double size = 0;      // root of the part of the image that its corners enclose
  // Angle between the board's normal and the line of sight in degrees, from the foreshortening of the board (too large
  // towards the edge of a fisheye's image), times the direction in the image in which the board recedes.
  double tilt_x = 0, tilt_y = 0;

  double tilt() const;
  // 0 if they look alike, 1 if they have nothing in common.
  double difference(const ViewShape& other) const;
};

ViewShape shape_of(const BoardView& view, const Board& board, cv::Size image);

// Coverage is enough for a calibration from here on.
struct CoverageGoal {
  int views = 20;
  double cells = 0.8;       // part of the image's cells in which corners were seen
  double tilt_deg = 20;     // at least tilted_views must be tilted so much to the left or right,
  int tilted_views = 3;     // and as many up or down
  double size_ratio = 1.4;  // the nearest view is so much larger than the farthest
};

class Coverage {
 public:
  static constexpr int kColumns = 8, kRows = 6;  // cells of the image

  Coverage(cv::Size image, const CoverageGoal& goal) : image_(image), goal_(goal) {}
  void add(const BoardView& view, const ViewShape& shape);

  int views() const { return static_cast<int>(shapes_.size()); }
  const std::vector<ViewShape>& shapes() const { return shapes_; }
  const CoverageGoal& goal() const { return goal_; }
  int corners(int row, int column) const { return corners_[row][column]; }  // seen in a cell
  double covered() const;                                                   // part of the cells
  // Advice to the person who holds the board, most important first; empty: the coverage is enough.
  std::vector<std::string> missing() const;
  // Number of views and ranges of position, tilt and size, a line each.
  std::vector<std::string> figures() const;
  // A picture of the cells in letters beside the figures; lines end with '\n'.
  std::string to_text() const;

 private:
  struct Range {
    double low = 0, high = 0;
  };
  Range range(double ViewShape::*field) const;
  int count_tilted(double ViewShape::*axis) const;
  std::string emptiest_region() const;

  cv::Size image_;
  CoverageGoal goal_;
  int corners_[kRows][kColumns] = {};
  std::vector<ViewShape> shapes_;
};

}  // namespace rumi::tool
