// SPDX-License-Identifier: BSD-3-Clause
// Trees, fences, lamp posts, signs and parked cars.
#include <cmath>

#include "synth/street_build.h"

namespace rumi::synth {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kParkedShare = 0.55;  // of the places along the kerb

Palette leaf_palette(cv::RNG& rng) {
  const int red = rng.uniform(-25, 45), green = rng.uniform(-20, 20);
  const auto colour = [&](int r, int g, int b) {
    return cv::Vec3b(cv::saturate_cast<uchar>(r), cv::saturate_cast<uchar>(g), cv::saturate_cast<uchar>(b));
  };
  return {colour(14, 26, 8), colour(132 + red, 172 + green, 74), {}};
}

class ThingBuilder {
 public:
  ThingBuilder(const StreetSite& site, StreetMeshBuilder* mesh) : s_(site), m_(site.models), mesh_(*mesh) {}

  void tree(const Place& place) {
    cv::RNG rng = rng_of(s_.seed, kTreeChance, place.number);
    const Vector3d foot = s_.on_ground(place.at);
    const Surface bark{pick(m_.bark, place.number), {{36, 28, 22}, {132, 112, 92}, {60, 80, 50}}};
    Model trunk;
    const double thick = 0.035 * place.size_m;
    add_box({0, 0, 0.25 * place.size_m - 0.2}, {thick, thick, 0.5 * place.size_m + 0.4}, bark, false, &trunk);
    mesh_.add(trunk, DrawnAs::kNear, Shadow::kMap, standing(foot, place.yaw_rad));
    Model crown = pick(m_.trees, place.number);
    for (Face& face : crown)
      for (Corner& corner : face.corners) corner.at *= place.size_m;
    const Palette colours = leaf_palette(rng);
    mesh_.add(crown, DrawnAs::kFarLeaves, Shadow::kLeaf, standing(foot, place.yaw_rad), &colours);
  }

  void strip(const Strip& strip) {
    cv::RNG rng = rng_of(s_.seed, kTownChance, strip.number);
    const Vector3d from = s_.on_ground(strip.from), to = s_.on_ground(strip.to);
    const double height = strip.kind == Strip::Kind::kHedge  ? rng.uniform(1.1, 1.4)
                          : strip.kind == Strip::Kind::kWall ? 0.8
                                                             : 1.15;
    const Vector3d along = to - from, up(0, 0, height), below(0, 0, -0.3);
    if (strip.kind == Strip::Kind::kFence) {
      const Surface slats{pick(m_.fences, strip.number / 16), {{40, 34, 28}, {214, 204, 186}, {}}};
      mesh_.add(rectangle(from + up, along, -up, slats), DrawnAs::kLeaves, Shadow::kMap);
      mesh_.add(rectangle(to + up, -along, -up, slats), DrawnAs::kLeaves, Shadow::kMap);
      return;
    }
    const bool hedge = strip.kind == Strip::Kind::kHedge;
    const double thick = hedge ? 0.5 : 0.2;
    const Surface surface =
        hedge ? Surface{pick(m_.hedges, strip.number), {{12, 24, 10}, {104, 146, 66}, {230, 200, 210}}}
              : Surface{pick(m_.walls, strip.number), {{46, 42, 40}, {184, 160, 138}, {90, 90, 60}}};
    Model model;
    add_box({0, 0, 0.5 * (height - 0.3)}, {along.norm() + 0.05, thick, height + 0.3}, surface, false, &model);
    if (!hedge)
      for (Face& face : model)
        for (Corner& corner : face.corners) corner.u = 0.1 * corner.u, corner.v = 0.88 + 0.1 * corner.v;
    mesh_.add(model, DrawnAs::kNear, Shadow::kMap, standing(0.5 * (from + to), std::atan2(along.y(), along.x())));
  }

  void lamp(const Place& place) {
    const double high = s_.style.cars ? 5.2 : 3.6;
    const Surface metal{pick(m_.metal, place.number), {{30, 34, 32}, {120, 128, 124}, {70, 60, 50}}};
    const Surface glass{pick(m_.metal, place.number), {{150, 150, 140}, {250, 248, 236}, {200, 200, 190}}};
    Model model;
    add_box({0, 0, 0.5 * high}, {0.11, 0.11, high}, metal, false, &model);
    add_box({0, 0, 0.45}, {0.2, 0.2, 0.9}, metal, false, &model);
    add_box({0.5, 0, high}, {1.1, 0.09, 0.08}, metal, false, &model);
    add_box({0.95, 0, high - 0.06}, {0.5, 0.2, 0.14}, glass, false, &model);
    mesh_.add(model, DrawnAs::kNear, Shadow::kMap, standing(s_.on_ground(place.at), place.yaw_rad));
  }

  // A traffic sign, a bin, a bench or a box for electricity.
  void sign(const Place& place) {
    cv::RNG rng = rng_of(s_.seed, kSignChance, place.number);
    const Surface metal{pick(m_.metal, place.number), {{50, 50, 52}, {168, 170, 172}, {90, 80, 60}}};
    const Surface board{
        pick(m_.signs, place.number),
        {{16, 16, 20}, {240, 240, 240}, rng.uniform(0, 2) ? cv::Vec3b(190, 24, 30) : cv::Vec3b(24, 70, 160)}};
    Model model;
    const int kind = rng.uniform(0, 4);
    if (kind < 2) {
      add_box({0, 0, 1.35}, {0.07, 0.07, 2.7}, metal, false, &model);
      for (const double turn : {0.0, M_PI}) {
        const size_t first = model.size();
        model.push_back(rectangle({0.045, -0.33, 2.65}, {0, 0.66, 0}, {0, 0, -0.66}, board));
        move_faces(standing(Vector3d::Zero(), M_PI / 2 + turn), first, &model);
      }
    } else if (kind == 2) {
      add_box({0, 0, 0.5}, {0.4, 0.4, 1.0}, {board.patch, {{20, 40, 26}, {110, 130, 104}, {40, 60, 44}}}, false,
              &model);
    } else {
      add_box({0, 0, 0.6}, {0.35, 1.1, 1.2},
              {pick(m_.walls, place.number), {{60, 64, 60}, {176, 180, 170}, {60, 60, 60}}}, false, &model);
    }
    mesh_.add(model, DrawnAs::kSmall, Shadow::kMap, standing(s_.on_ground(place.at), place.yaw_rad));
  }

  void parked_car(const Place& place) {
    cv::RNG rng = rng_of(s_.seed + 7919 * static_cast<uint64_t>(s_.day), kParkingChance, place.number);
    if (rng.uniform(0.0, 1.0) > kParkedShare) return;
    const CarModel& car = m_.cars[static_cast<size_t>(rng.uniform(0, static_cast<int>(m_.cars.size())))];
    const Palette colours = car_palette(rng);
    const double yaw = place.yaw_rad + rng.uniform(-0.03, 0.03) + (rng.uniform(0, 5) == 0 ? M_PI : 0);
    // A car stands on its wheels, so it is tilted as the road.
    const Vector2d t(std::cos(yaw), std::sin(yaw));
    const double slope = (s_.field.ground_m(place.at + 1.3 * t) - s_.field.ground_m(place.at - 1.3 * t)) / 2.6;
    SE3 pose = standing({place.at.x(), place.at.y(), s_.field.ground_m(place.at)}, yaw);
    pose.rotation = pose.rotation * Eigen::AngleAxisd(-std::atan(slope), Vector3d::UnitY());
    mesh_.add(car.model, DrawnAs::kNear, Shadow::kMap, pose, &colours);
  }

 private:
  const StreetSite& s_;
  const StreetModels& m_;
  StreetMeshBuilder& mesh_;
};

}  // namespace

void build_things(const StreetSite& site, StreetMeshBuilder* mesh) {
  ThingBuilder builder(site, mesh);
  for (const Place& place : site.plan.trees) builder.tree(place);
  for (const Strip& strip : site.plan.strips) builder.strip(strip);
  for (const Place& place : site.plan.lamps) builder.lamp(place);
  for (const Place& place : site.plan.signs) builder.sign(place);
  for (const Place& place : site.plan.parking) builder.parked_car(place);
}

}  // namespace rumi::synth
