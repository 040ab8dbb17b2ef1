// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/calibration/coverage.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace rumi::tool {
namespace {

constexpr double kDegrees = 180 / M_PI;

// Sets the tilt from the homography at `middle`, where its derivative maps a circle to an ellipse.
void set_tilt(const cv::Matx33d& h, const cv::Point2d& middle, ViewShape* shape) {
  const cv::Vec3d p = h * cv::Vec3d(middle.x, middle.y, 1);
  const double u = p[0] / p[2], v = p[1] / p[2];
  Eigen::Matrix2d image_from_board;
  image_from_board << h(0, 0) - u * h(2, 0), h(0, 1) - u * h(2, 1),  //
      h(1, 0) - v * h(2, 0), h(1, 1) - v * h(2, 1);
  image_from_board /= p[2];
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> ellipse(image_from_board * image_from_board.transpose());
  const Eigen::Vector2d axes = ellipse.eigenvalues().cwiseMax(0).cwiseSqrt();
  const double tilt = kDegrees * std::acos(std::min(1.0, axes[0] / axes[1]));
  Eigen::Vector2d direction = ellipse.eigenvectors().col(0);  // in which the board is foreshortened
  const double recedes = Eigen::Vector2d(h(2, 0), h(2, 1)).dot(image_from_board.inverse() * direction) * p[2];
  if (recedes < 0) direction = -direction;
  shape->tilt_x = tilt * direction.x();
  shape->tilt_y = tilt * direction.y();
}

}  // namespace

double ViewShape::tilt() const { return std::hypot(tilt_x, tilt_y); }

double ViewShape::difference(const ViewShape& other) const {
  // Each of these differences counts 0.1: a shift by a tenth of the image, 1.4 times the size, a tilt by 15 degrees.
  const double nearer = 0.3 * std::log(size / other.size);
  const double tilted = std::hypot(tilt_x - other.tilt_x, tilt_y - other.tilt_y) / 150;
  return std::hypot(std::hypot(x - other.x, y - other.y), std::hypot(nearer, tilted));
}

ViewShape shape_of(const BoardView& view, const Board& board, cv::Size image) {
  ViewShape shape;
  std::vector<cv::Point2f> on_board, hull;
  cv::Point2d middle_px, middle_mm;
  for (size_t i = 0; i < view.corners.size(); ++i) {
    const cv::Point2d mm = board.corner_mm(view.corners[i]);
    on_board.emplace_back(mm);
    middle_mm += mm / static_cast<double>(view.corners.size());
    middle_px += cv::Point2d(view.pixels[i]) / static_cast<double>(view.corners.size());
  }
  shape.x = middle_px.x / image.width;
  shape.y = middle_px.y / image.height;
  cv::convexHull(view.pixels, hull);
  shape.size = std::sqrt(cv::contourArea(hull) / image.area());
  const cv::Mat homography = cv::findHomography(on_board, view.pixels);
  if (!homography.empty()) set_tilt(cv::Matx33d(homography), middle_mm, &shape);
  return shape;
}

void Coverage::add(const BoardView& view, const ViewShape& shape) {
  shapes_.push_back(shape);
  for (const cv::Point2f& pixel : view.pixels) {
    const int column = std::clamp(cvFloor(pixel.x * kColumns / image_.width), 0, kColumns - 1);
    const int row = std::clamp(cvFloor(pixel.y * kRows / image_.height), 0, kRows - 1);
    ++corners_[row][column];
  }
}

double Coverage::covered() const {
  int covered = 0;
  for (const auto& row : corners_)
    for (const int count : row) covered += count > 0 ? 1 : 0;
  return static_cast<double>(covered) / (kColumns * kRows);
}

int Coverage::count_tilted(double ViewShape::*axis) const {
  return static_cast<int>(std::count_if(
      shapes_.begin(), shapes_.end(), [&](const ViewShape& shape) { return std::abs(shape.*axis) >= goal_.tilt_deg; }));
}

Coverage::Range Coverage::range(double ViewShape::*field) const {
  if (shapes_.empty()) return {};
  const auto [low, high] = std::minmax_element(
      shapes_.begin(), shapes_.end(), [&](const ViewShape& a, const ViewShape& b) { return a.*field < b.*field; });
  return {(*low).*field, (*high).*field};
}

// Returns the name of that one of nine parts of the image in which most cells are empty.
std::string Coverage::emptiest_region() const {
  static constexpr const char* kNames[3][3] = {{"upper left corner", "upper edge", "upper right corner"},
                                               {"left edge", "middle", "right edge"},
                                               {"lower left corner", "lower edge", "lower right corner"}};
  double most = -1;
  std::string name;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) {
      int cells = 0, empty = 0;
      for (int y = r * kRows / 3; y < (r + 1) * kRows / 3; ++y)
        for (int x = c * kColumns / 3; x < (c + 1) * kColumns / 3; ++x) ++cells, empty += corners_[y][x] == 0 ? 1 : 0;
      const double part = static_cast<double>(empty) / cells;
      if (part > most) most = part, name = kNames[r][c];
    }
  }
  return name;
}

std::vector<std::string> Coverage::missing() const {
  std::vector<std::string> missing;
  if (covered() < goal_.cells)
    missing.push_back(fmt::format("hold the board at the {} of the image", emptiest_region()));
  if (count_tilted(&ViewShape::tilt_x) < goal_.tilted_views)
    missing.push_back("turn its left or right side away from the camera, by 30 to 45 degrees");
  if (count_tilted(&ViewShape::tilt_y) < goal_.tilted_views)
    missing.push_back("turn its upper or lower side away from the camera, by 30 to 45 degrees");
  const Range size = range(&ViewShape::size);
  if (shapes_.empty() || size.high < goal_.size_ratio * size.low)
    missing.push_back(size.high < 0.5 ? "hold it nearer, so that it fills most of the image" : "hold it farther away");
  if (views() < goal_.views) missing.push_back(fmt::format("{} more views", goal_.views - views()));
  return missing;
}

std::vector<std::string> Coverage::figures() const {
  const Range tilt_x = range(&ViewShape::tilt_x), tilt_y = range(&ViewShape::tilt_y), size = range(&ViewShape::size);
  return {fmt::format("{} views; corners in {:.0f} % of the image", views(), 100 * covered()),
          fmt::format("tilt left/right: {:+.0f} to {:+.0f} degrees", tilt_x.low, tilt_x.high),
          fmt::format("tilt up/down: {:+.0f} to {:+.0f} degrees", tilt_y.low, tilt_y.high),
          fmt::format("size: {:.0f} to {:.0f} % of the image's sides", 100 * size.low, 100 * size.high)};
}

std::string Coverage::to_text() const {
  const std::vector<std::string> beside = figures();
  std::string text = "+" + std::string(2 * kColumns, '-') + "+\n";
  for (int row = 0; row < kRows; ++row) {
    text += "|";
    for (int column = 0; column < kColumns; ++column) text += corners_[row][column] > 0 ? "##" : "  ";
    text += "|";
    const size_t line = static_cast<size_t>(row) - 1;
    if (line < beside.size()) text += "  " + beside[line];
    text += "\n";
  }
  return text + "+" + std::string(2 * kColumns, '-') + "+\n";
}

}  // namespace rumi::tool
