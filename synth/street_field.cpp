// SPDX-License-Identifier: BSD-3-Clause
#include "synth/street_field.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace rumi::synth {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kMargin_m = 60;     // ground around the route
constexpr double kMinLength_m = 10;  // of a route
constexpr double kMaxArea_m2 = 16e6;
constexpr double kBuiltCell_m = 0.5;
constexpr double kProbe_m = 0.7;  // footprints are looked at in such steps

double distance_to_segment(const Vector2d& p, const Vector2d& a, const Vector2d& b) {
  const Vector2d ab = b - a;
  const double u = std::clamp((p - a).dot(ab) / std::max(1e-12, ab.squaredNorm()), 0.0, 1.0);
  return (a + u * ab - p).norm();
}

// Calls f with points of the footprint that are kProbe_m apart or less, its edges included.
template <class F>
void probe(const Footprint& f, const F& see) {
  const int n = static_cast<int>(std::ceil(f.width_m / kProbe_m)),
            m = static_cast<int>(std::ceil(f.depth_m / kProbe_m));
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= m; ++j) see(f.at(f.width_m * i / n, f.depth_m * j / m));
}

}  // namespace

Result<> StreetField::check(const Route& route) {
  if (route.length_m() < kMinLength_m)
    return Error{fmt::format("is {:.0f} m long: a street needs {:.0f} m", route.length_m(), kMinLength_m), "path"};
  Vector2d low = route.points()[0].head<2>(), high = low;
  for (const Vector3d& p : route.points()) {
    low = low.cwiseMin(p.head<2>());
    high = high.cwiseMax(p.head<2>());
  }
  const Vector2d size = high - low;
  if ((size.x() + 2 * kMargin_m) * (size.y() + 2 * kMargin_m) > kMaxArea_m2)
    return Error{fmt::format("goes over {:.0f} by {:.0f} m: a town has at most {:.0f} square kilometres", size.x(),
                             size.y(), kMaxArea_m2 / 1e6),
                 "path", "give a part of it as a file of its own"};
  return {};
}

StreetField::StreetField(const Route& route) {
  low_ = route.points()[0].head<2>();
  Vector2d high = low_;
  for (const Vector3d& p : route.points()) {
    low_ = low_.cwiseMin(p.head<2>());
    high = high.cwiseMax(p.head<2>());
  }
  low_.array() -= kMargin_m;
  columns_ = static_cast<int>(std::ceil((high.x() + kMargin_m - low_.x()) / kCell_m));
  rows_ = static_cast<int>(std::ceil((high.y() + kMargin_m - low_.y()) / kCell_m));
  built_ = cv::Mat::zeros(rows_ * 4 + 1, columns_ * 4 + 1, CV_8U);
  measure(route);
  smooth_ground(route);
}

void StreetField::measure(const Route& route) {
  distance_ = cv::Mat(rows_ * 2 + 1, columns_ * 2 + 1, CV_32F, cv::Scalar(kReach_m));
  const int reach = static_cast<int>(kReach_m);
  for (size_t i = 0; i + 1 < route.points().size(); ++i) {
    const Vector2d a = route.points()[i].head<2>() - low_, b = route.points()[i + 1].head<2>() - low_;
    const int x0 = std::max(0, static_cast<int>(a.x()) - reach), y0 = std::max(0, static_cast<int>(a.y()) - reach);
    const int x1 = std::min(distance_.cols - 1, static_cast<int>(a.x()) + reach);
    const int y1 = std::min(distance_.rows - 1, static_cast<int>(a.y()) + reach);
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) {
        float& value = distance_.at<float>(y, x);
        // Only a segment whose point is nearer than the best one so far, but for a segment's length, may be nearer.
        if ((Vector2d(x, y) - a).squaredNorm() < (value + 1) * (value + 1))
          value = std::min(value, static_cast<float>(distance_to_segment(Vector2d(x, y), a, b)));
      }
  }
}

// Spreads the camera's heights over the ground: near the route with a narrow filter, and with wider ones the farther it
// is. Where the route passes twice, the ground is the mean of both.
void StreetField::smooth_ground(const Route& route) {
  cv::Mat weight = cv::Mat::zeros(rows_ + 1, columns_ + 1, CV_32F), sum = weight.clone();
  for (const Vector3d& p : route.points()) {
    const Vector2d cell = (p.head<2>() - low_) / kCell_m;
    const cv::Point at(static_cast<int>(std::lround(cell.x())), static_cast<int>(std::lround(cell.y())));
    weight.at<float>(at) += 1;
    sum.at<float>(at) += static_cast<float>(p.z() - kCameraHeight_m);
  }
  ground_ = cv::Mat(weight.size(), CV_32F, cv::Scalar(cv::sum(sum)[0] / cv::sum(weight)[0]));
  for (const double sigma_m : {160.0, 80.0, 40.0, 20.0, 10.0, 6.0}) {
    const double sigma = sigma_m / kCell_m;
    // Wide filters are as good, and much faster, on a coarser grid.
    const double shrink = std::clamp(sigma / 4, 1.0, 16.0);
    const cv::Size coarse(std::max(2, static_cast<int>(weight.cols / shrink)),
                          std::max(2, static_cast<int>(weight.rows / shrink)));
    cv::Mat w, s;
    cv::resize(weight, w, coarse, 0, 0, cv::INTER_AREA);
    cv::resize(sum, s, coarse, 0, 0, cv::INTER_AREA);
    cv::GaussianBlur(w, w, {}, sigma / shrink, sigma / shrink, cv::BORDER_CONSTANT);
    cv::GaussianBlur(s, s, {}, sigma / shrink, sigma / shrink, cv::BORDER_CONSTANT);
    cv::resize(w, w, weight.size(), 0, 0, cv::INTER_CUBIC);
    cv::resize(s, s, weight.size(), 0, 0, cv::INTER_CUBIC);
    const float doubt = static_cast<float>(0.02 * kCell_m / sigma_m);  // of the density on the route itself
    for (int y = 0; y < ground_.rows; ++y)
      for (int x = 0; x < ground_.cols; ++x) {
        const float known = std::max(0.f, w.at<float>(y, x));
        if (known <= 1e-7f) continue;
        float& z = ground_.at<float>(y, x);
        z = (known * (s.at<float>(y, x) / known) + doubt * z) / (known + doubt);
      }
  }
}

double StreetField::distance_m(const Vector2d& at) const {
  const Vector2d p = at - low_;
  if (p.x() < 0 || p.y() < 0 || p.x() >= distance_.cols - 1 || p.y() >= distance_.rows - 1) return kReach_m;
  const int x = static_cast<int>(p.x()), y = static_cast<int>(p.y());
  const double u = p.x() - x, v = p.y() - y;
  return (1 - v) * ((1 - u) * distance_.at<float>(y, x) + u * distance_.at<float>(y, x + 1)) +
         v * ((1 - u) * distance_.at<float>(y + 1, x) + u * distance_.at<float>(y + 1, x + 1));
}

double StreetField::ground_m(const Vector2d& at) const {
  const Vector2d p = (at - low_) / kCell_m;
  const double px = std::clamp(p.x(), 0.0, columns_ - 1e-6), py = std::clamp(p.y(), 0.0, rows_ - 1e-6);
  const int x = static_cast<int>(px), y = static_cast<int>(py);
  const double u = px - x, v = py - y;
  const double a = ground_.at<float>(y, x), b = ground_.at<float>(y, x + 1), c = ground_.at<float>(y + 1, x),
               d = ground_.at<float>(y + 1, x + 1);
  return u + v < 1 ? a + u * (b - a) + v * (c - a) : d + (1 - u) * (c - d) + (1 - v) * (b - d);
}

cv::Point StreetField::built_cell(const Vector2d& at) const {
  const Vector2d cell = (at - low_) / kBuiltCell_m;
  return {static_cast<int>(std::floor(cell.x())), static_cast<int>(std::floor(cell.y()))};
}

bool StreetField::is_free(const Footprint& footprint, double clear_m) const {
  const cv::Rect all({}, built_.size());
  bool free = true;
  probe(footprint, [&](const Vector2d& at) {
    const cv::Point cell = built_cell(at);
    if (!all.contains(cell) || built_.at<uchar>(cell) || distance_m(at) < clear_m) free = false;
  });
  return free;
}

bool StreetField::is_free(const Vector2d& at, double radius_m) const {
  const Vector2d x = Vector2d::UnitX(), y = Vector2d::UnitY();
  return is_free({at - radius_m * (x + y), x, y, 2 * radius_m, 2 * radius_m}, 0);
}

void StreetField::build(const Footprint& footprint) {
  const cv::Rect all({}, built_.size());
  Footprint f = footprint;
  // Steps finer than a cell leave none out.
  const int n = static_cast<int>(std::ceil(f.width_m / 0.3)), m = static_cast<int>(std::ceil(f.depth_m / 0.3));
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= m; ++j) {
      const cv::Point cell = built_cell(f.at(f.width_m * i / n, f.depth_m * j / m));
      if (all.contains(cell)) built_.at<uchar>(cell) = 1;
    }
}

void StreetField::build(const Vector2d& at, double radius_m) {
  const Vector2d x = Vector2d::UnitX(), y = Vector2d::UnitY();
  build({at - radius_m * (x + y), x, y, 2 * radius_m, 2 * radius_m});
}

}  // namespace rumi::synth
