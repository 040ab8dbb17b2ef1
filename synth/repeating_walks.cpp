// SPDX-License-Identifier: BSD-3-Clause
#include "synth/repeating_walks.h"

#include <algorithm>
#include <cmath>

#include "synth/handheld.h"

namespace rumi::synth {
namespace {

using Eigen::Vector3d;

constexpr int kStoreys = 3;
constexpr double kStorey_m = 3.2, kCeiling_m = 2.8;
constexpr double kLift_s = 3;
constexpr double kBlank_s = 2.5;  // how long nothing is seen on the other walks
constexpr double kPace_m_s = 0.4, kSampleHz = 100, kStart_s = 1000;

SE3 moved(const Vector3d& by) { return {Eigen::Quaterniond::Identity(), by}; }
SE3 turned(double yaw_rad) { return {so3_exp({0, 0, yaw_rad}), Vector3d::Zero()}; }

HardPassage blank(double at_s, double for_s) { return {HardPassage::Kind::kTextureless, at_s, for_s}; }

// Moves from one pose to another without a jump of speed at either end.
SE3 between(const SE3& from, const SE3& to, double u) {
  const double eased = u * u * (3 - 2 * u);
  return {from.rotation.slerp(eased, to.rotation), from.translation + eased * (to.translation - from.translation)};
}

}  // namespace

Walk walk_to_twin_room(double seconds, uint64_t seed) {
  Walk walk = walk_to_next_room(seconds, seed);
  Repeats repeats;
  repeats.cell = {{-5.2, -3.1, 0}, {-walk.doorway->wall_m / 2, 3.1, kCeiling_m}};
  repeats.walls = {true, true, true, true};
  repeats.copies = {turned(0), turned(M_PI)};
  // Each copy has its half of the wall.
  walk.doorway->at.x() = -walk.doorway->wall_m / 4;
  walk.doorway->wall_m /= 2;
  repeats.cell.high.x() = -walk.doorway->wall_m;
  walk.repeats = repeats;
  return walk;
}

Walk walk_up_storeys(double seconds, uint64_t seed) {
  Walk walk;
  Repeats repeats{.cell = {{-3.2, -3, 0}, {3.2, 3, kCeiling_m}}, .walls = {true, true, true, true}};
  const double each_s = (seconds - (kStoreys - 1) * kLift_s) / kStoreys;
  double at_s = kStart_s;
  SE3 last;
  for (int storey = 0; storey < kStoreys; ++storey) {
    const SE3 lifted = moved({0, 0, storey * kStorey_m});
    repeats.copies.push_back(lifted);
    const CameraPath about = CameraPath::walk(each_s, seed * kStoreys + static_cast<uint64_t>(storey));
    if (storey > 0) {
      const SE3 first = lifted * about.at(about.times_s().front());
      for (double t = 1 / kSampleHz; t < kLift_s; t += 1 / kSampleHz)
        walk.path.add(at_s + t, between(last, first, t / kLift_s));
      walk.hard.push_back(blank(at_s - kStart_s, kLift_s));
      at_s += kLift_s;
    }
    for (double t = 0; t < each_s; t += 1 / kSampleHz)
      walk.path.add(at_s + t, last = lifted * about.at(about.times_s().front() + t));
    at_s += each_s;
  }
  walk.repeats = repeats;
  return walk;
}

Walk walk_past_doors(double seconds, uint64_t seed) {
  cv::RNG rng(seed * 7919 + 41);
  const auto slow = [&] { return Wobble(rng, {2 / seconds, 3 / seconds, 5 / seconds}); };
  const auto fast = [&] { return Wobble(rng, {1.1, 1.9, 3.3}); };
  const Wobble aside = slow(), height = slow(), gaze = slow(), tilt = slow();
  const Wobble shake = fast(), nod = fast(), roll = fast();
  Walk walk;
  for (double t = 0; t <= seconds; t += 1 / kSampleHz) {
    // The camera looks aside at first, so that it begins with sideways motion, and more and more ahead.
    const double yaw = M_PI / 2 - 0.6 * std::min(1.0, t / 6) * (1 + 0.3 * gaze.at(t));
    walk.path.add(kStart_s + t,
                  look({kPace_m_s * t, 0.12 * aside.at(t) + 0.008 * shake.at(t), 1.5 + 0.1 * height.at(t)},
                       yaw + 0.008 * shake.at(t), -0.08 + 0.1 * tilt.at(t) + 0.008 * nod.at(t), 0.02 * roll.at(t)));
  }
  walk.hard.push_back(blank((seconds - kBlank_s) / 2, kBlank_s));
  Repeats repeats{.cell = {{0, -1.6, 0}, {kDoorEvery_m, 1.6, kCeiling_m}}, .walls = {true, false, true, false}};
  repeats.doors = {std::vector<double>{-0.6}, {}, {0.7}, {}};
  const int last = static_cast<int>(kPace_m_s * seconds / kDoorEvery_m) + 6;
  for (int k = -4; k <= last; ++k) repeats.copies.push_back(moved({k * kDoorEvery_m, 0, 0}));
  walk.repeats = repeats;
  return walk;
}

Walk walk_round_square(double seconds, uint64_t seed) {
  Walk walk{.path = CameraPath::walk(seconds, seed)};
  for (const double share : {0.3, 0.65}) walk.hard.push_back(blank(share * seconds, kBlank_s));
  // A quarter with two half sides: four of them, turned about the middle, are the square.
  Repeats repeats{.cell = {{0, 0, 0}, {3.6, 3.6, 3.4}}, .walls = {false, true, true, false}};
  for (int k = 0; k < 4; ++k) repeats.copies.push_back(turned(k * M_PI / 2));
  walk.repeats = repeats;
  return walk;
}

}  // namespace rumi::synth
