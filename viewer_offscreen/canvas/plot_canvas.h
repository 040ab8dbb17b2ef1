// SPDX-License-Identifier: BSD-3-Clause
// Anti-aliased discs, lines and triangles in pixel coordinates, and points in space, drawn by OpenGL at twice the size.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "viewer_offscreen/gl/offscreen_context.h"
#include "viewer_offscreen/scene/projection.h"

namespace rumi::viewer_offscreen {

struct Ink {
  cv::Vec3b rgb;
  double alpha = 1;
};

class PlotCanvas {
 public:
  static constexpr int kScale = 2;  // factor by which the drawing is larger than the canvas

  PlotCanvas(int width, int height);

  void clear(const cv::Vec3b& rgb);
  // From now on, draws only within this rectangle.
  void clip(const cv::Rect& panel);
  void unclip();
  void disc(cv::Point2d center, double radius, const Ink& ink);
  void line(cv::Point2d a, cv::Point2d b, double width, const Ink& ink);
  void dashed(cv::Point2d a, cv::Point2d b, double width, double dash, const Ink& ink);
  void rectangle(const cv::Rect2d& area, const Ink& ink);
  void triangle(cv::Point2d a, cv::Point2d b, cv::Point2d c, const Ink& ink);
  // Loads points in space. They stay until the next call.
  void set_points(const std::vector<Eigen::Vector3f>& points);
  // Draws squares of `size` pixels at the projections of loaded points: of `count` points from `first` on, every
  // `step`th.
  void points(size_t first, size_t count, size_t step, const Projection& project, double size, const Ink& ink);
  // Returns the picture, BGR, kScale times as large as the canvas.
  cv::Mat read();

 private:
  struct Corner {
    float x, y;        // clip coordinates
    float u, v;        // 1 at the shape's edge
    float half_width;  // from the shape's middle to its edge, in pixels of the enlarged picture
    uint8_t rgba[4];
  };
  void corner(cv::Point2d at, float u, float v, double half_width, const Ink& ink);
  void quad(const cv::Point2d (&at)[4], double half_width, bool round, const Ink& ink);
  void flush();
  OffscreenContext context_;
  std::vector<Corner> corners_;
  unsigned program_ = 0, vertex_array_ = 0, buffer_ = 0;
  unsigned point_program_ = 0, point_array_ = 0, point_buffer_ = 0;
};

}  // namespace rumi::viewer_offscreen
