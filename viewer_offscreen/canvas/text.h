// SPDX-License-Identifier: BSD-3-Clause
// Draws text on a picture that is PlotCanvas::kScale times as large as the final one. Positions and sizes are in pixels
// of the final picture.
#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace rumi::viewer_offscreen {

struct TextStyle {
  double height_px = 12;  // height of a capital letter
  cv::Vec3b rgb{40, 40, 44};
  bool bold = false;
};

// Draws text; `at` is the left end of its base line. Letters outside ASCII become '?'.
void draw_text(cv::Mat& large, cv::Point2d at, const std::string& text, const TextStyle& style);
// Draws the text on a pale plate, so that it can be read on any background.
void draw_label(cv::Mat& large, cv::Point2d at, const std::string& text, const TextStyle& style);
double text_width(const std::string& text, const TextStyle& style);
// Returns the text, or as much of it as fits in `width` with "..." at its end.
std::string fit_text(const std::string& text, double width, const TextStyle& style);

}  // namespace rumi::viewer_offscreen
