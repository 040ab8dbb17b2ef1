// SPDX-License-Identifier: BSD-3-Clause
#include "viewer_offscreen/picture/camera_inset.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "viewer_offscreen/canvas/palette.h"
#include "viewer_offscreen/canvas/plot_canvas.h"

namespace rumi::viewer_offscreen {
namespace {

constexpr int kScale = PlotCanvas::kScale;
constexpr int kShift = 4;  // fractional bits of the positions of circles

cv::Scalar bgr(const cv::Vec3b& rgb) { return {double(rgb[2]), double(rgb[1]), double(rgb[0])}; }

void draw_marks(cv::Mat& image, const std::vector<cv::Point2f>& pixels, cv::Size size, double radius,
                const cv::Scalar& color, int thickness) {
  const double sx = static_cast<double>(image.cols) / size.width, sy = static_cast<double>(image.rows) / size.height;
  for (const cv::Point2f& pixel : pixels) {
    if (!(pixel.x >= 0 && pixel.y >= 0 && pixel.x < static_cast<float>(size.width) &&
          pixel.y < static_cast<float>(size.height)))
      continue;
    const cv::Point at(static_cast<int>((pixel.x + 0.5) * sx * (1 << kShift)),
                       static_cast<int>((pixel.y + 0.5) * sy * (1 << kShift)));
    cv::circle(image, at, static_cast<int>(radius * kScale * (1 << kShift)), color, thickness, cv::LINE_AA, kShift);
  }
}

}  // namespace

cv::Rect inset_area(const CameraView& view, const cv::Rect& room) {
  if (view.image.empty()) return {};
  const double scale =
      std::min(static_cast<double>(room.width) / view.image.cols, static_cast<double>(room.height) / view.image.rows);
  const int width = std::max(1, static_cast<int>(view.image.cols * scale)),
            height = std::max(1, static_cast<int>(view.image.rows * scale));
  return {room.x + (room.width - width) / 2, room.y, width, height};
}

void draw_inset(cv::Mat& large, const CameraView& view, const cv::Rect& area, const cv::Vec3b& color) {
  const cv::Rect pixels(area.x * kScale, area.y * kScale, area.width * kScale, area.height * kScale);
  cv::Mat target = large(pixels);
  cv::resize(view.image, target, pixels.size(), 0, 0, cv::INTER_LINEAR);
  if (view.size.width > 0 && view.size.height > 0) {
    draw_marks(target, view.others, view.size, 1.2, bgr({235, 235, 235}), 1);
    draw_marks(target, view.on_landmarks, view.size, 1.9, bgr(kPanelColor), cv::FILLED);
    draw_marks(target, view.on_landmarks, view.size, 1.4, bgr(color), cv::FILLED);
  }
  cv::rectangle(large, pixels, bgr(kFrameColor), kScale);
}

}  // namespace rumi::viewer_offscreen
