// SPDX-License-Identifier: BSD-3-Clause
#include "viewer_offscreen/canvas/text.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "viewer_offscreen/canvas/plot_canvas.h"

namespace rumi::viewer_offscreen {
namespace {

constexpr double kCapitalHeight_px = 21;  // height of a capital letter of the Hershey font at scale 1

double font_scale(const TextStyle& style) { return PlotCanvas::kScale * style.height_px / kCapitalHeight_px; }
int thickness(const TextStyle& style) {
  return std::max(1, static_cast<int>(std::lround(PlotCanvas::kScale * style.height_px * (style.bold ? 0.15 : 0.11))));
}
constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;

}  // namespace

void draw_text(cv::Mat& large, cv::Point2d at, const std::string& text, const TextStyle& style) {
  const cv::Point where(static_cast<int>(std::lround(at.x * PlotCanvas::kScale)),
                        static_cast<int>(std::lround(at.y * PlotCanvas::kScale)));
  cv::putText(large, text, where, kFont, font_scale(style), cv::Scalar(style.rgb[2], style.rgb[1], style.rgb[0]),
              thickness(style), cv::LINE_AA);
}

void draw_label(cv::Mat& large, cv::Point2d at, const std::string& text, const TextStyle& style) {
  const double pad = 3, k = PlotCanvas::kScale;
  const cv::Rect2d plate(at.x - pad, at.y - style.height_px - pad, text_width(text, style) + 2 * pad,
                         style.height_px + 2 * pad + 1);
  const cv::Rect pixels = cv::Rect(cv::Rect2d(plate.x * k, plate.y * k, plate.width * k, plate.height * k)) &
                          cv::Rect(0, 0, large.cols, large.rows);
  cv::Mat under = large(pixels);
  cv::addWeighted(under, 0.2, cv::Mat(under.size(), under.type(), cv::Scalar::all(255)), 0.8, 0, under);
  draw_text(large, at, text, style);
}

double text_width(const std::string& text, const TextStyle& style) {
  return cv::getTextSize(text, kFont, font_scale(style), thickness(style), nullptr).width / double(PlotCanvas::kScale);
}

std::string fit_text(const std::string& text, double width, const TextStyle& style) {
  if (text_width(text, style) <= width) return text;
  std::string shorter = text;
  while (!shorter.empty() && text_width(shorter + "...", style) > width) shorter.pop_back();
  return shorter + "...";
}

}  // namespace rumi::viewer_offscreen
