// SPDX-License-Identifier: BSD-3-Clause
#include "synth/street_plan.h"

#include <algorithm>
#include <cmath>

namespace rumi::synth {
namespace {

using Eigen::Vector2d;

constexpr double kStorey_m = 2.9;
constexpr double kStrip_m = 2;        // length of one piece of a fence
constexpr double kRemoteFrom_m = 22;  // houses of which only the upper parts are seen are farther from the route
constexpr double kRemoteEvery_m = 26;
constexpr double kParkingEvery_m = 6.3, kParking_m = 4.2;  // places for cars along the kerb, and their distance
constexpr double kWalk_m = 22;                             // length of a person's stretch

double yaw_of(const Vector2d& v) { return std::atan2(v.y(), v.x()); }

class Planner {
 public:
  Planner(const Route& route, const StreetStyle& style, uint64_t seed, StreetField& field)
      : route_(route), style_(style), seed_(seed), field_(field) {}

  StreetPlan plan() {
    for (const double side : {-1.0, 1.0}) line_with_houses(side);
    for (const double side : {-1.0, 1.0}) line_with_strips(side);
    place_remote_houses();
    if (style_.cars) place_parking();
    place_beside(style_.lamp_every_m, kLampChance, &StreetPlan::lamps);
    place_beside(style_.tree_every_m, kTreeChance, &StreetPlan::trees);
    place_beside(34, kSignChance, &StreetPlan::signs);
    place_garden_trees();
    paint_road();
    place_walkers();
    return std::move(plan_);
  }

 private:
  // Builds houses along the whole route, on one side (1: left), wherever they fit.
  void line_with_houses(double side) {
    double way = -style_.width_m[1];
    while (way < route_.length_m() + style_.width_m[1]) {
      cv::RNG rng = rng_of(seed_, kHouseChance, ++number_);
      const double width = rng.uniform(style_.width_m[0], style_.width_m[1]);
      const double setback = rng.uniform(0, 3) ? style_.setback_m[0] + rng.uniform(0.0, 0.6)
                                               : rng.uniform(style_.setback_m[0], style_.setback_m[1]);
      if (!build_house(way, side, width, setback, rng)) {
        way += 1.5;
        continue;
      }
      const bool attached = rng.uniform(0.0, 1.0) < style_.attached;
      way += width + (attached ? 0.1 : rng.uniform(style_.gap_m[0], style_.gap_m[1]));
    }
  }

  bool build_house(double way, double side, double width, double setback, cv::RNG& rng) {
    const Vector2d begin = route_.at(way), end = route_.at(way + width);
    if ((end - begin).norm() < 0.7 * width) return false;  // around the corner
    const Vector2d t = (end - begin).normalized(), inward = side * Vector2d(-t.y(), t.x());
    const Vector2d along = side * t;
    const Vector2d front = 0.5 * (begin + end) + setback * inward;
    Footprint f{front - 0.5 * width * along, along, inward, width, rng.uniform(style_.depth_m[0], style_.depth_m[1])};
    if (!field_.is_free(f, style_.house_m)) {
      f.depth_m = 0.6 * style_.depth_m[0];
      if (!field_.is_free(f, style_.house_m)) return false;
    }
    add_house(f, rng.uniform(style_.storeys[0], style_.storeys[1] + 1), false, rng);
    return true;
  }

  void add_house(const Footprint& f, int storeys, bool remote, cv::RNG& rng) {
    field_.build(f);
    House house{.footprint = f,
                .storeys = storeys,
                .shop = style_.cars && rng.uniform(0, 4) == 0,
                .remote = remote,
                .number = number_};
    double low = 1e9, high = -1e9, front = -1e9;
    for (const double a : {0.0, 0.5, 1.0})
      for (const double b : {0.0, 1.0}) {
        const double z = field_.ground_m(f.at(a * f.width_m, b * f.depth_m));
        low = std::min(low, z);
        high = std::max(high, z);
        if (b == 0) front = std::max(front, z);
      }
    house.floor_m = front + style_.kerb_height_m + rng.uniform(0.05, 0.35);
    house.foot_m = low - 0.5;
    house.eaves_m = storeys * kStorey_m + rng.uniform(0.2, 1.2) + std::max(0.0, high - front);
    const bool flat = rng.uniform(0.0, 1.0) < (style_.cars ? 0.2 : 0.7);
    house.ridge_m = flat ? 0 : 0.5 * f.depth_m * rng.uniform(0.55, 1.0);
    plan_.houses.push_back(house);
  }

  // Closes the gaps between the houses.
  void line_with_strips(double side) {
    Strip::Kind kind = Strip::Kind::kHedge;
    bool gate = false;
    for (double way = 0; way + kStrip_m <= route_.length_m(); way += kStrip_m) {
      cv::RNG rng = rng_of(seed_, kTownChance, ++number_);
      if (rng.uniform(0, 6) == 0) {
        kind = static_cast<Strip::Kind>(rng.uniform(0, 3));
        gate = rng.uniform(0.0, 1.0) < (style_.cars ? 0.2 : 0.75);
      }
      if (gate) continue;
      const double left = side * style_.fence_m;
      const Vector2d from = route_.beside(way, left), to = route_.beside(way + kStrip_m, left);
      const Vector2d middle = 0.5 * (from + to);
      const double length = (to - from).norm();
      if (length < 0.5 * kStrip_m || length > 1.6 * kStrip_m) continue;
      if (field_.distance_m(from) < style_.fence_m - 0.35 || field_.distance_m(to) < style_.fence_m - 0.35) continue;
      if (!field_.is_free(middle, 0.1) || !field_.is_free(0.8 * from + 0.2 * to, 0.1)) continue;
      plan_.strips.push_back({kind, from, to, number_});
      strip_marks_.push_back(middle);
      // Neighbours touch, so a piece counts as built only when its neighbours stand. Another pass finds it.
      if (strip_marks_.size() < 4) continue;
      field_.build(strip_marks_.front(), 0.6);
      strip_marks_.erase(strip_marks_.begin());
    }
    for (const Vector2d& middle : strip_marks_) field_.build(middle, 0.6);
    strip_marks_.clear();
  }

  // A second row of houses, and higher ones that are seen above the roofs, on a loose grid.
  void place_remote_houses() {
    const double beyond = 260;
    for (double y = field_.low().y() - beyond; y < field_.high().y() + beyond; y += kRemoteEvery_m)
      for (double x = field_.low().x() - beyond; x < field_.high().x() + beyond; x += kRemoteEvery_m) {
        cv::RNG rng = rng_of(seed_, kHouseChance, ++number_);
        const Vector2d at(x + rng.uniform(-8.0, 8.0), y + rng.uniform(-8.0, 8.0));
        const double yaw = rng.uniform(0.0, M_PI);
        const bool outside = field_.distance_m(at) >= StreetField::kReach_m - 1;
        if (rng.uniform(0.0, 1.0) < (outside ? 0.55 : 0.15)) continue;
        const double width = rng.uniform(9.0, 17.0), depth = rng.uniform(8.0, 12.0);
        const Vector2d along(std::cos(yaw), std::sin(yaw)), inward(-along.y(), along.x());
        const Footprint f{at - 0.5 * width * along - 0.5 * depth * inward, along, inward, width, depth};
        const bool tower = outside && rng.uniform(0, 5) == 0;
        const int storeys = tower ? rng.uniform(6, 14) : rng.uniform(2, 5);
        const bool inside_grid =
            (at.array() > field_.low().array() + 15).all() && (at.array() < field_.high().array() - 15).all();
        if (inside_grid && !field_.is_free(f, kRemoteFrom_m)) continue;
        add_house(f, storeys, true, rng);
      }
  }

  void place_parking() {
    for (const double side : {-1.0, 1.0})
      for (double way = 3; way < route_.length_m(); way += kParkingEvery_m) {
        ++number_;
        const Vector2d at = route_.beside(way, side * kParking_m), t = route_.ahead(way);
        const Footprint f{at - 2.3 * t - 0.95 * Vector2d(-t.y(), t.x()), t, {-t.y(), t.x()}, 4.6, 1.9};
        if (!field_.is_free(f, kParking_m - 1.05) || field_.distance_m(at) > kParking_m + 0.3) continue;
        field_.build(f);
        plan_.parking.push_back({at, yaw_of(t) + (side > 0 ? M_PI : 0), 4.3, number_});
      }
  }

  void place_beside(double every_m, ChanceOf chance, std::vector<Place> StreetPlan::*kind) {
    for (const double side : {-1.0, 1.0})
      for (double way = 1; way < route_.length_m(); way += every_m) {
        cv::RNG rng = rng_of(seed_, chance, ++number_);
        const bool tree = chance == kTreeChance;
        const double away =
            tree ? rng.uniform(style_.tree_m[0], style_.tree_m[1]) : style_.lamp_m + rng.uniform(0.0, 0.2);
        const double place = way + rng.uniform(-0.35, 0.35) * every_m;
        if (rng.uniform(0, 5) < (chance == kLampChance ? 1 : 2)) continue;
        const Vector2d at = route_.beside(place, side * away), t = route_.ahead(place);
        if (field_.distance_m(at) < away - 0.4 || !field_.is_free(at, tree ? 0.5 : 0.3)) continue;
        field_.build(at, tree ? 1.6 : 0.5);
        const double size = tree ? rng.uniform(5.0, 9.0) : rng.uniform(0.95, 1.05);
        (plan_.*kind).push_back({at, yaw_of(-side * Vector2d(-t.y(), t.x())), size, number_});
      }
  }

  // Trees behind the fences, and where nothing else is.
  void place_garden_trees() {
    for (double y = field_.low().y() + 4; y < field_.high().y() - 4; y += 9)
      for (double x = field_.low().x() + 4; x < field_.high().x() - 4; x += 8) {
        cv::RNG rng = rng_of(seed_, kTreeChance, ++number_);
        const Vector2d at(x + rng.uniform(-3.0, 3.0), y + rng.uniform(-3.0, 3.0));
        const double distance = field_.distance_m(at), size = rng.uniform(5.0, 11.0);
        if (rng.uniform(0, 10) < 2 || distance < style_.fence_m + 2 || distance > 34) continue;
        if (!field_.is_free(at, 1.6)) continue;
        field_.build(at, 1.6);
        plan_.trees.push_back({at, rng.uniform(0.0, 2 * M_PI), size, number_});
      }
  }

  // Paints a mark unless another one of its kind is nearer than `apart_m`.
  void paint(std::vector<Place>& marks, double way, double left, double size, double apart_m) {
    const Vector2d at = route_.beside(way, left);
    if (field_.distance_m(at) > style_.kerb_m - 0.5) return;
    for (const Place& other : marks)
      if ((other.at - at).squaredNorm() < apart_m * apart_m) return;
    marks.push_back({at, yaw_of(route_.ahead(way)), size, ++number_});
  }

  void paint_road() {
    cv::RNG rng = rng_of(seed_, kMarkChance, 0);
    const double length = route_.length_m(), wide = style_.kerb_m - 0.8;
    for (double way = 0; way < length; way += 4.5)
      if (style_.cars) paint(plan_.dashes, way, 1.25, 1.7, 3.6);
    for (double way = 30; way < length; way += rng.uniform(60.0, 130.0))
      if (style_.cars) paint(plan_.zebras, way, 0, 3.2, 30);
    for (double way = 0; way < length; way += rng.uniform(5.0, 16.0))
      paint(plan_.manholes, way, rng.uniform(-wide, wide), rng.uniform(0.55, 0.75), 3);
    for (double way = 0; way < length; way += rng.uniform(1.5, 9.0))
      paint(plan_.patches, way, rng.uniform(-wide, wide), rng.uniform(0.5, 2.8), 2.5);
  }

  void place_walkers() {
    for (const double side : {-1.0, 1.0})
      for (double way = 0; way + kWalk_m < route_.length_m(); way += style_.walker_every_m) {
        Stretch stretch{way, way + kWalk_m, side * style_.walker_m, ++number_};
        bool free = true;
        for (double s = 0; s <= kWalk_m; s += 1)
          free &= field_.distance_m(route_.beside(way + s, stretch.left_m)) > style_.walker_m - 0.5;
        if (free) plan_.walkers.push_back(stretch);
      }
  }

  const Route& route_;
  const StreetStyle& style_;
  uint64_t seed_;
  StreetField& field_;
  StreetPlan plan_;
  std::vector<Vector2d> strip_marks_;
  uint64_t number_ = 0;
};

}  // namespace

StreetPlan plan_street(const Route& route, const StreetStyle& style, uint64_t seed, StreetField* field) {
  return Planner(route, style, seed, *field).plan();
}

}  // namespace rumi::synth
