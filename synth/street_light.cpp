// SPDX-License-Identifier: BSD-3-Clause
#include "synth/street_light.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace rumi::synth {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kShadow_m = 70;  // no shadow is longer
constexpr float kNothing_m = -1e6f;
constexpr int kMostPixels = 4096;     // of a side of the map of shadows
constexpr double kLightReach_m = 40;  // shadows on the ground are drawn up to this distance from the route
constexpr uchar kShade = 0;

}  // namespace

StreetDay make_day(uint64_t seed, int day) {
  cv::RNG rng = rng_of(seed, kDayChance, static_cast<uint64_t>(day));
  const double azimuth = rng.uniform(0.0, 2 * M_PI), elevation = rng.uniform(24.0, 52.0) * M_PI / 180;
  const double clouds = day == 1 ? 0.35 : rng.uniform(0.15, 0.95);
  StreetDay out;
  out.to_sun = {std::cos(azimuth) * std::cos(elevation), std::sin(azimuth) * std::cos(elevation), std::sin(elevation)};
  out.clouds = clouds;
  const double overcast = std::clamp((clouds - 0.5) / 0.4, 0.0, 1.0), bright = day == 1 ? 1 : rng.uniform(0.75, 1.1);
  out.sky = bright * (0.42 + 0.22 * overcast);
  out.sun = bright * (0.95 - 0.8 * overcast);
  return out;
}

StreetLight::StreetLight(const StreetDay& day, const StreetField& field, const StreetPlan& plan)
    : day_(day), low_(field.low()) {
  const Vector2d size = field.high() - field.low();
  cell_m_ = std::max(0.5, size.maxCoeff() / kMostPixels);
  top_ = cv::Mat(static_cast<int>(std::ceil(size.y() / cell_m_)), static_cast<int>(std::ceil(size.x() / cell_m_)),
                 CV_32F, cv::Scalar(kNothing_m));
  raise(plan, field);
  draw_map(field);
}

void StreetLight::raise(const StreetPlan& plan, const StreetField& field) {
  const auto pixel = [&](const Vector2d& at) {
    const Vector2d p = (at - low_) / cell_m_ * 16;
    return cv::Point(static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y())));
  };
  for (const Place& tree : plan.trees)
    cv::circle(top_, pixel(tree.at), static_cast<int>(0.24 * tree.size_m / cell_m_ * 16),
               field.ground_m(tree.at) + 0.9 * tree.size_m, cv::FILLED, cv::LINE_8, 4);
  for (const House& house : plan.houses) {
    const Footprint& f = house.footprint;
    // The roof is two steps: the eaves, and the middle half of the house at half the height of the roof.
    for (const double inset : {0.0, 0.25}) {
      std::vector<cv::Point> corners;
      for (const auto& [a, b] : {std::pair{0.0, inset}, {1.0, inset}, {1.0, 1 - inset}, {0.0, 1 - inset}})
        corners.push_back(pixel(f.at(a * f.width_m, b * f.depth_m)));
      cv::fillConvexPoly(top_, corners, house.floor_m + house.eaves_m + 2 * inset * house.ridge_m, cv::LINE_8, 4);
    }
  }
}

void StreetLight::draw_map(const StreetField& field) {
  map_ = cv::Mat(top_.size(), CV_8U, cv::Scalar(255));
  for (int y = 0; y < map_.rows; ++y)
    for (int x = 0; x < map_.cols; ++x) {
      const Vector2d at = low_ + cell_m_ * Vector2d(x + 0.5, y + 0.5);
      if (field.distance_m(at) > kLightReach_m) continue;
      if (!sees_sun({at.x(), at.y(), field.ground_m(at) + 0.2})) map_.at<uchar>(y, x) = kShade;
    }
  cv::GaussianBlur(map_, map_, {3, 3}, 0.7);
}

double StreetLight::sky(const Vector3d& normal) const { return day_.sky * (0.72 + 0.28 * normal.z()); }

double StreetLight::sun(const Vector3d& normal) const { return day_.sun * std::max(0.0, normal.dot(day_.to_sun)); }

bool StreetLight::sees_sun(const Vector3d& at) const {
  const double across = day_.to_sun.head<2>().norm();
  const Vector2d step = day_.to_sun.head<2>() / across * cell_m_ * 1.2;
  const double rise = day_.to_sun.z() / across * cell_m_ * 1.2;
  Vector2d p = (at.head<2>() - low_);
  double z = at.z();
  for (double way = 0; way < kShadow_m; way += 1.2 * cell_m_) {
    p += step;
    z += rise;
    const int x = static_cast<int>(p.x() / cell_m_), y = static_cast<int>(p.y() / cell_m_);
    if (p.x() < 0 || p.y() < 0 || x >= top_.cols || y >= top_.rows) return true;
    if (top_.at<float>(y, x) > z) return false;
  }
  return true;
}

}  // namespace rumi::synth
