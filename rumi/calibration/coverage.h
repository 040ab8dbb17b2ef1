// SPDX-License-Identifier: BSD-3-Clause
// Measures how much of the image the views of a board cover, and from how many sides they show it. A calibration needs
// both.
#pragma once

#include <opencv2/core/types.hpp>
#include <string>
#include <vector>

#include "rumi/calibration/board_detector.h"

namespace rumi::tool {

// How a board lies in an image, described without knowing the camera.
struct ViewShape {
  double x = 0, y = 0;  // mean of its corners / width and height of the image
  double size = 0;      // square root of (area that its corners enclose / area of the image)
  // The angle in degrees between the board's normal and the line of sight, times the direction in the image in which
  // the board recedes. It is estimated from the foreshortening of the board: too large near the edge of a fisheye's
  // image.
  double tilt_x = 0, tilt_y = 0;

  double tilt() const;
  // Returns 0 if they look the same; 0.1 is, for example, a tilt by 15 degrees.
  double difference(const ViewShape& other) const;
};

ViewShape shape_of(const BoardView& view, const Board& board, cv::Size image);

// If all of these are reached, the coverage is enough for a calibration.
struct CoverageGoal {
  int views = 20;
  double cells = 0.8;  // cells of the image in which corners were seen / all cells
  // At least tilted_views views must be tilted by tilt_deg or more to the left or right, and as many up or down.
  double tilt_deg = 20;
  int tilted_views = 3;
  double size_ratio = 1.4;  // size of the nearest view / size of the farthest
};

class Coverage {
 public:
  static constexpr int kColumns = 8, kRows = 6;  // cells of the image

  Coverage(cv::Size image, const CoverageGoal& goal) : image_(image), goal_(goal) {}
  void add(const BoardView& view, const ViewShape& shape);

  int views() const { return static_cast<int>(shapes_.size()); }
  const std::vector<ViewShape>& shapes() const { return shapes_; }
  const CoverageGoal& goal() const { return goal_; }
  int corners(int row, int column) const { return corners_[row][column]; }  // number of corners seen in a cell
  double covered() const;  // share of the cells in which corners were seen
  // Returns advice to the person who holds the board, most important first; empty if the coverage is enough.
  std::vector<std::string> missing() const;
  // Returns the number of views, and the ranges of position, tilt and size, one line each.
  std::vector<std::string> figures() const;
  // Returns a picture of the cells, drawn with letters, beside the figures. Lines end with '\n'.
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
