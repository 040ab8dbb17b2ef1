// SPDX-License-Identifier: BSD-3-Clause
#include "synth/street_traffic.h"

#include <algorithm>
#include <cmath>

namespace rumi::synth {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kEncounterEvery_s = 6;
constexpr double kOncoming = 0.5, kOvertaking = 0.14, kLeading = 0.4, kPeople = 0.5;  // shares of the occasions
constexpr double kLane_m = 2.4;                                                       // the other lane, to the left
constexpr double kEncounter_s = 16;                                                   // from first to last sight
constexpr double kLeadingFor_s = 40, kLeadingGap_m = 14, kLeadingGone_m = 130;
constexpr double kPersonInSight_m = 70;
constexpr double kStep_m = 1.5;  // of two legs

double smooth_step(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return u * u * (3 - 2 * u);
}

}  // namespace

cv::RNG StreetTraffic::chance(uint64_t kind, uint64_t number) const {
  return rng_of(s_.seed + 104729 * static_cast<uint64_t>(s_.day), kTrafficChance, kind * 1000003 + number);
}

void StreetTraffic::add(double time_s, const Vector2d& camera, Triangles* out) const {
  if (share_ <= 0) return;
  if (s_.style.cars) {
    add_encounters(time_s - begin_s_, out);
    add_leading_car(time_s - begin_s_, out);
  }
  add_people(time_s - begin_s_, camera, out);
}

void StreetTraffic::add_car(double way_m, double left_m, bool backwards, cv::RNG rng, Triangles* out) const {
  if (way_m < 0 || way_m > route_.length_m()) return;
  const CarModel& car = s_.models.cars[static_cast<size_t>(rng.uniform(0, static_cast<int>(s_.models.cars.size())))];
  const Palette colours = car_palette(rng);
  const Vector2d at = route_.beside(way_m, left_m);
  const double half = car.length_m * 0.3;
  const Vector2d rear = route_.beside(way_m - half, left_m), front = route_.beside(way_m + half, left_m);
  Vector3d t(front.x() - rear.x(), front.y() - rear.y(), s_.field.ground_m(front) - s_.field.ground_m(rear));
  if (backwards) t = -t;
  t.normalize();
  SE3 pose = standing({at.x(), at.y(), s_.field.ground_m(at)}, std::atan2(t.y(), t.x()));
  pose.rotation = pose.rotation * Eigen::AngleAxisd(-std::asin(std::clamp(t.z(), -0.5, 0.5)), Vector3d::UnitY());
  for (const Face& face : car.model) add_face(face, pose, &colours, s_.light, Shadow::kMap, out);
}

// Cars that the camera meets, and cars that overtake it: at most one in each span of time.
void StreetTraffic::add_encounters(double t, Triangles* out) const {
  const int last = static_cast<int>(std::floor((t + kEncounter_s) / kEncounterEvery_s));
  for (int k = std::max(0, last - 6); k <= last; ++k) {
    cv::RNG rng = chance(1, static_cast<uint64_t>(k));
    const double met_s = (k + rng.uniform(0.0, 1.0)) * kEncounterEvery_s, kind = rng.uniform(0.0, 1.0) / share_;
    const double from_met = t - met_s;
    if (kind < kOncoming) {
      if (from_met < -kEncounter_s + 4 || from_met > 4) continue;
      add_car(route_.way_m(begin_s_ + met_s) - rng.uniform(7.0, 13.0) * from_met, kLane_m, true, rng, out);
    } else if (kind < kOncoming + kOvertaking) {
      if (from_met < -4 || from_met > kEncounter_s - 4) continue;
      const double gap = rng.uniform(5.0, 8.0) * from_met;
      add_car(route_.way_m(begin_s_ + t) + gap, kLane_m, false, rng, out);
    }
  }
}

void StreetTraffic::add_leading_car(double t, Triangles* out) const {
  const int k = static_cast<int>(std::floor(t / kLeadingFor_s));
  cv::RNG rng = chance(2, static_cast<uint64_t>(k));
  if (rng.uniform(0.0, 1.0) / share_ > kLeading) return;
  const double u = t / kLeadingFor_s - k;
  const double away = 1 - smooth_step(u / 0.25) + smooth_step((u - 0.75) / 0.25);
  const double gap = kLeadingGap_m + rng.uniform(0.0, 10.0) + 3 * std::sin(t * 0.4) + away * kLeadingGone_m;
  add_car(route_.way_m(begin_s_ + t) + gap, 0.1, false, rng, out);
}

void StreetTraffic::add_people(double t, const Vector2d& camera, Triangles* out) const {
  for (const Stretch& stretch : s_.plan.walkers) {
    if ((route_.at(stretch.from_m) - camera).norm() > kPersonInSight_m) continue;
    cv::RNG rng = chance(3, stretch.number);
    if (rng.uniform(0.0, 1.0) / share_ > kPeople) continue;
    const double length = stretch.to_m - stretch.from_m, speed = rng.uniform(0.9, 1.6);
    const double walked = speed * t + rng.uniform(0.0, 2 * length), turn = std::fmod(walked, 2 * length);
    const double way = stretch.from_m + (turn < length ? turn : 2 * length - turn);
    const Vector2d at = route_.beside(way, stretch.left_m + rng.uniform(-0.35, 0.35));
    const Vector2d ahead = route_.ahead(way) * (turn < length ? 1 : -1);
    const Model body = person(s_.models.person, rng.uniform(1.5, 1.9), walked / kStep_m,
                              stretch.number + static_cast<uint64_t>(s_.day) * 977);
    const SE3 pose = standing(s_.on_ground(at), std::atan2(ahead.y(), ahead.x()));
    for (const Face& face : body) add_face(face, pose, nullptr, s_.light, Shadow::kMap, out);
  }
}

void StreetTraffic::add_lorry(double phase, const SE3& street_from_cam, double half_view, Triangles* out) const {
  constexpr double kComes = 0.22, kIn = 0.3, kLeaves = 0.78;
  const Vector3d z = street_from_cam.rotation * Vector3d::UnitZ();
  const double yaw = std::atan2(z.y(), z.x());
  // At this distance its back covers nine tenths of the width.
  const double near = std::max(0.9, StreetModels::kLorryWidth_m / 2 / (0.9 * half_view));
  const double from = -StreetModels::kLorry_m - 4;
  const double along = phase < kComes ? from + (near + 0.6 - from) * phase / kComes
                                      : near + 0.6 * (1 - smooth_step((phase - kComes) / 0.08)) +
                                            90 * std::pow(std::max(0.0, (phase - kLeaves) / (1 - kLeaves)), 2);
  const double left =
      2.5 * (1 - smooth_step((phase - 0.9 * kComes) / (kIn - 0.9 * kComes))) + 0.08 * std::sin(25 * phase);
  const Vector2d camera = street_from_cam.translation.head<2>();
  const Vector2d ahead(std::cos(yaw), std::sin(yaw)),
      at = camera + along * ahead + left * Vector2d(-ahead.y(), ahead.x());
  const double ground = s_.field.ground_m(camera) + 0.03 * std::sin(40 * phase);
  for (const Face& face : s_.models.lorry)
    add_face(face, standing({at.x(), at.y(), ground}, yaw), nullptr, s_.light, Shadow::kMap, out);
}

}  // namespace rumi::synth
