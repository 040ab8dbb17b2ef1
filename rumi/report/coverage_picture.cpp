// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/report/coverage_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "rumi/report/plot_axes.h"

namespace rumi::tool {
namespace {

constexpr int kMargin = 24, kTop = 64, kLine = 20;
constexpr int kImageWidth = 640, kImageHeight = 480;  // largest size of the area for the image
constexpr int kTiltSide = 420;
constexpr int kTiltLeft = kMargin + kImageWidth + 90, kTiltNote = kTop + kTiltSide + 46;
constexpr int kText = kTop + kImageHeight + 36, kMissingLeft = 440;
constexpr int kWidth = kTiltLeft + kTiltSide + kMargin, kHeight = kText + 6 * kLine;
const cv::Scalar kSeen(238, 244, 226);

// The area of the picture that stands for the image.
struct Frame {
  explicit Frame(cv::Size image)
      : scale(
            std::min(static_cast<double>(kImageWidth) / image.width, static_cast<double>(kImageHeight) / image.height)),
        area(kMargin, kTop, cvRound(image.width * scale), cvRound(image.height * scale)) {}
  // Returns the place of a pixel of the image; (0, 0) is the centre of the upper left one.
  cv::Point at(const cv::Point2f& pixel) const {
    return area.tl() + cv::Point(cvRound((pixel.x + 0.5) * scale), cvRound((pixel.y + 0.5) * scale));
  }
  cv::Rect cell(int row, int column) const {
    const auto x = [this](int c) { return area.x + area.width * c / Coverage::kColumns; };
    const auto y = [this](int r) { return area.y + area.height * r / Coverage::kRows; };
    return {cv::Point(x(column), y(row)), cv::Point(x(column + 1), y(row + 1))};
  }
  double scale;
  cv::Rect area;
};

// Fills the cells in which corners were seen, and crosses out the others.
void draw_cells(cv::Mat& picture, const Frame& frame, const Coverage& coverage) {
  for (int row = 0; row < Coverage::kRows; ++row) {
    for (int column = 0; column < Coverage::kColumns; ++column) {
      const cv::Rect cell = frame.cell(row, column);
      if (coverage.corners(row, column) > 0) {
        cv::rectangle(picture, cell, kSeen, cv::FILLED);
      } else {
        cv::line(picture, cell.tl(), cell.br(), kPlotGrey, 1, cv::LINE_AA);
        cv::line(picture, {cell.x, cell.br().y}, {cell.br().x, cell.y}, kPlotGrey, 1, cv::LINE_AA);
      }
      cv::rectangle(picture, cell, kPlotGrid);
    }
  }
  cv::rectangle(picture, frame.area, kPlotGrey);
}

void draw_views(cv::Mat& picture, const Frame& frame, const std::vector<BoardView>& views) {
  for (const BoardView& view : views) {
    std::vector<cv::Point> corners, outline;
    for (const cv::Point2f& pixel : view.pixels) corners.push_back(frame.at(pixel));
    cv::convexHull(corners, outline);
    cv::polylines(picture, outline, true, kPlotGrey, 1, cv::LINE_AA);
    for (const cv::Point& corner : corners) cv::circle(picture, corner, 2, kPlotBlue, cv::FILLED, cv::LINE_AA);
  }
}

// Draws each view as a circle, larger if the board is nearer. A view beyond the black lines is tilted enough.
void draw_tilts(cv::Mat& picture, const Coverage& coverage) {
  double limit = 50;
  for (const ViewShape& shape : coverage.shapes())
    limit = std::max({limit, std::abs(shape.tilt_x) + 5, std::abs(shape.tilt_y) + 5});
  const PlotAxes axes(picture, {kTiltLeft, kTop, kTiltSide, kTiltSide}, -limit, limit, -limit, limit, "");
  for (const double enough : {-coverage.goal().tilt_deg, coverage.goal().tilt_deg}) {
    cv::line(picture, axes.at(enough, -limit), axes.at(enough, limit), kPlotBlack, 1, cv::LINE_AA);
    cv::line(picture, axes.at(-limit, enough), axes.at(limit, enough), kPlotBlack, 1, cv::LINE_AA);
  }
  for (const ViewShape& shape : coverage.shapes())
    cv::circle(picture, axes.at(shape.tilt_x, shape.tilt_y), cvRound(2 + 16 * shape.size), kPlotBlue, 1, cv::LINE_AA);
}

void draw_lines(cv::Mat& picture, const std::vector<std::string>& lines, int left) {
  int y = kText;
  for (const std::string& line : lines) plot_text(picture, line, {left, y}), y += kLine;
}

}  // namespace

cv::Mat draw_coverage(const ViewCollector& collector) {
  cv::Mat picture(kHeight, kWidth, CV_8UC3, kPlotWhite);
  const Coverage coverage = collector.coverage();
  const Frame frame(collector.image_size());
  plot_text(picture, collector.counts().to_string(), {kMargin, 24});
  plot_text(picture, "the board in the image; crossed out: parts where it was not seen", {kMargin, kTop - 12});
  plot_text(picture, "its tilt left/right (across) and up/down, degrees", {kTiltLeft, kTop - 12});
  plot_text(picture, "a circle is a view, the larger the nearer;", {kTiltLeft, kTiltNote});
  plot_text(picture, fmt::format("beyond the black lines it is tilted enough, by {:.0f}", coverage.goal().tilt_deg),
            {kTiltLeft, kTiltNote + kLine});
  draw_cells(picture, frame, coverage);
  draw_views(picture, frame, collector.taken());
  draw_tilts(picture, coverage);
  draw_lines(picture, coverage.figures(), kMargin);
  std::vector<std::string> missing = coverage.missing();
  missing.insert(missing.begin(), missing.empty() ? "enough" : "missing:");
  draw_lines(picture, missing, kMissingLeft);
  return picture;
}

}  // namespace rumi::tool
