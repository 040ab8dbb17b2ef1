// SPDX-License-Identifier: BSD-3-Clause
#include "synth/street_route.h"

#include <algorithm>
#include <cmath>

namespace rumi::synth {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kStanding_m = 0.2;   // a camera that moves less than this stands
constexpr double kHeadingOver_m = 2;  // the direction is that of the way from here before to here after a place

}  // namespace

SE3 street_from_map(const CameraPath& path) { return {shortest_turn(path.up(), Vector3d::UnitZ()), Vector3d::Zero()}; }

Route::Route(const CameraPath& path, const SE3& street_from_map) {
  std::vector<Vector3d> places;
  for (const double time_s : path.times_s()) {
    const Vector3d at = street_from_map * path.at(time_s).translation;
    const double step_m = places.empty() ? 0 : (at - places.back()).head<2>().norm();
    if (!places.empty() && step_m < kStanding_m) continue;
    times_s_.push_back(time_s);
    ways_m_.push_back(places.empty() ? 0 : ways_m_.back() + step_m);
    places.push_back(at);
  }
  const int metres = std::max(1, static_cast<int>(std::ceil(ways_m_.back())));
  size_t k = 0;
  for (int m = 0; m <= metres; ++m) {
    while (k + 2 < ways_m_.size() && ways_m_[k + 1] < m) ++k;
    if (ways_m_.size() == 1) {
      points_.push_back(places[0] + m * Vector3d::UnitX());
      continue;
    }
    const double u = (m - ways_m_[k]) / (ways_m_[k + 1] - ways_m_[k]);
    points_.push_back((1 - u) * places[k] + u * places[k + 1]);
  }
}

double Route::way_m(double time_s) const {
  if (time_s <= times_s_.front()) return 0;
  if (time_s >= times_s_.back()) return ways_m_.back();
  const size_t i = std::upper_bound(times_s_.begin(), times_s_.end(), time_s) - times_s_.begin() - 1;
  const double u = (time_s - times_s_[i]) / (times_s_[i + 1] - times_s_[i]);
  return (1 - u) * ways_m_[i] + u * ways_m_[i + 1];
}

Vector2d Route::at(double way_m) const {
  const double last = length_m();
  const double inside = std::clamp(way_m, 0.0, last);
  const size_t i = std::min(static_cast<size_t>(inside), points_.size() - 2);
  const Vector2d a = points_[i].head<2>(), b = points_[i + 1].head<2>();
  const Vector2d on_way = a + (inside - static_cast<double>(i)) * (b - a);
  if (inside == way_m) return on_way;
  return on_way + (way_m - inside) * ahead(inside);
}

Vector2d Route::ahead(double way_m) const {
  const double inside = std::clamp(way_m, 0.0, length_m());
  const double from = std::max(0.0, inside - kHeadingOver_m), to = std::min(length_m(), inside + kHeadingOver_m);
  const Vector2d chord = at(to) - at(from);
  return chord.norm() > 1e-6 ? Vector2d(chord.normalized()) : Vector2d(Vector2d::UnitX());
}

Vector2d Route::beside(double way_m, double left_m) const {
  const Vector2d t = ahead(way_m);
  return at(way_m) + left_m * Vector2d(-t.y(), t.x());
}

}  // namespace rumi::synth
