// SPDX-License-Identifier: BSD-3-Clause
// Axes, grid and words of a drawn diagram.
#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace rumi::tool {

// Components: blue, green, red.
inline const cv::Scalar kPlotWhite(255, 255, 255), kPlotBlack(30, 30, 30), kPlotGrid(225, 225, 225),
    kPlotGrey(150, 150, 150), kPlotBlue(190, 90, 20), kPlotRed(40, 40, 200);

void plot_text(cv::Mat& image, const std::string& words, cv::Point at, const cv::Scalar& colour = kPlotBlack);

// An area of the picture with linear axes. The constructor draws the grid.
class PlotAxes {
 public:
  PlotAxes(cv::Mat& image, cv::Rect area, double x_min, double x_max, double y_min, double y_max, const char* unit);
  cv::Point at(double x, double y) const {
    return {area_.x + cvRound((x - x_min_) * x_scale_), area_.y + area_.height - cvRound((y - y_min_) * y_scale_)};
  }

 private:
  cv::Mat& image_;
  cv::Rect area_;
  double x_min_, y_min_, x_scale_ = 1, y_scale_ = 1;
};

}  // namespace rumi::tool
