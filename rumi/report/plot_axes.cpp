// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/report/plot_axes.h"

#include <fmt/format.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace rumi::tool {
namespace {

// Returns 1, 2 or 5 times a power of ten, so that `range` has about `steps` such steps.
double round_step(double range, int steps) {
  const double raw = range / steps;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  for (double factor : {1.0, 2.0, 5.0}) {
    if (raw <= factor * power) return factor * power;
  }
  return 10 * power;
}

}  // namespace

void plot_text(cv::Mat& image, const std::string& words, cv::Point at, const cv::Scalar& colour) {
  cv::putText(image, words, at, cv::FONT_HERSHEY_SIMPLEX, 0.45, colour, 1, cv::LINE_AA);
}

PlotAxes::PlotAxes(cv::Mat& image, cv::Rect area, double x_min, double x_max, double y_min, double y_max,
                   const char* unit)
    : image_(image), area_(area), x_min_(x_min), y_min_(y_min) {
  x_scale_ = area.width / (x_max - x_min);
  y_scale_ = area.height / (y_max - y_min);
  const double x_step = round_step(x_max - x_min, 8), y_step = round_step(y_max - y_min, 5);
  for (double x = std::ceil(x_min / x_step) * x_step; x <= x_max; x += x_step) {
    const cv::Point p = at(x, y_min);
    cv::line(image_, p, at(x, y_max), kPlotGrid);
    plot_text(image_, fmt::format("{:.4g}", std::abs(x) < 1e-9 ? 0.0 : x), {p.x - 10, p.y + 18});
  }
  for (double y = std::ceil(y_min / y_step) * y_step; y <= y_max; y += y_step) {
    const cv::Point p = at(x_min, y);
    cv::line(image_, p, at(x_max, y), kPlotGrid);
    plot_text(image_, fmt::format("{:.4g} {}", std::abs(y) < 1e-9 ? 0.0 : y, unit), {p.x - 54, p.y + 4});
  }
  cv::rectangle(image_, area_, kPlotGrey);
}

}  // namespace rumi::tool
