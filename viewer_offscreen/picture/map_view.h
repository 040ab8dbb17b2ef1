// SPDX-License-Identifier: BSD-3-Clause
// Draws one view of submaps that share a frame of reference, in a panel of the picture.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "viewer_offscreen/canvas/plot_canvas.h"
#include "viewer_offscreen/scene/scene.h"

namespace rumi::viewer_offscreen {

enum class ViewKind { kOblique, kTop, kSide, kFollow };

struct MapViewStyle {
  ViewKind kind = ViewKind::kTop;
  double line_px = 1.8, landmark_px = 1;
  bool keyframes = false;  // draws frusta, and the path's shadow on the floor
  int label_px = 0;        // pixels kept free at the top for a label
};

class MapViews {
 public:
  // Loads the landmarks into the canvas. Both must outlive this object.
  MapViews(PlotCanvas& canvas, const Scene& scene);
  struct Drawn {
    double grid = 0;              // length of a grid cell in the map's unit; 0: nothing was drawn
    std::optional<double> scale;  // pixels per unit; nullopt in a perspective
  };
  Drawn draw(const std::vector<const SubmapView*>& shown, const cv::Rect& panel, const MapViewStyle& style);

 private:
  void draw_landmarks(const std::vector<const SubmapView*>& shown, const Projection& project, size_t step,
                      double size_px);

  PlotCanvas& canvas_;
  const Scene& scene_;
  std::vector<size_t> first_landmark_;  // index of each submap's first landmark, and at last the number of landmarks
};

void draw_panel(PlotCanvas& canvas, const cv::Rect& panel);
// Draws a line in the style of a submap. That of a back submap has a white core.
void draw_path_line(PlotCanvas& canvas, cv::Point2d a, cv::Point2d b, double width, const SubmapView& submap);
void draw_lost_line(PlotCanvas& canvas, cv::Point2d a, cv::Point2d b);
void draw_merge(PlotCanvas& canvas, cv::Point2d a, cv::Point2d b, bool same_images);

}  // namespace rumi::viewer_offscreen
