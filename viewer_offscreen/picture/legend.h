// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "viewer_offscreen/canvas/plot_canvas.h"
#include "viewer_offscreen/scene/scene.h"

namespace rumi::viewer_offscreen {

// Draws the legend of a picture in two passes, because OpenGL draws the lines but not the letters: first samples of the
// line styles, then the words beside them. What does not fit into the panel is left out, and the last row says how
// much.
class Legend {
 public:
  Legend(const Scene& scene, const cv::Rect& panel);
  void draw_samples(PlotCanvas& canvas) const;
  void draw_words(cv::Mat& large) const;

 private:
  enum class Sample { kNone, kSubmap, kLost, kTruth, kSameImages, kSamePlace, kCovisible };
  struct Row {
    Sample sample = Sample::kNone;
    const SubmapView* submap = nullptr;
    std::string text, detail;
    bool strong = false;
  };
  void add_submaps(const Scene& scene, size_t rows_left);
  void add_joints(const Scene& scene);
  void add_lost(const Scene& scene);
  double baseline(size_t row) const;
  cv::Rect panel_;
  std::vector<Row> rows_;
};

}  // namespace rumi::viewer_offscreen
