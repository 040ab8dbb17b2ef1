// SPDX-License-Identifier: BSD-3-Clause
#include "synth/next_room_walk.h"

#include <algorithm>
#include <cmath>

#include "synth/handheld.h"

namespace rumi::synth {
namespace {

using Eigen::Vector2d;

constexpr double kStart_s = 1000;  // not 0, because a time of 0 often means that there is no time
constexpr double kSampleHz = 100;
// On the floor the walk is an S: an arc around the middle of one room, a straight line through the doorway that is
// tangent to both arcs, and an arc around the middle of the other room. Both ends are straight lines, so that the walk
// begins with pure sideways motion, from which front_tracker can begin a submap.
constexpr double kMiddle_m = 2.3;  // from the doorway to the middle of a room
constexpr double kRadius_m = 1.2;
constexpr double kArc_rad = 190 * M_PI / 180;
constexpr double kEnd_m = 0.8;
constexpr double kPassage_s = 2.6;  // how long the camera is out of focus and in the dark, in the middle of the walk
constexpr double kTurn_s = 1.6;     // how long the camera turns within the passage
constexpr double kHurry_m = 1.4;    // extra way in the passage, compared with the usual pace
// These values make front_tracker lose the camera, but SIFT still matches: 4 pixels out of focus at 640 pixels of
// width, and a bit more than half of the light.
constexpr double kBlur = 0.8, kDarkness = 0.4;
// The camera looks straight away from the middle of its room. At the doorway this direction differs by 180 degrees
// between the rooms, so a person looks ahead, which makes the turn smaller: by up to kAhead_rad in the last kAhead_s
// before the passage, and by kAheadAfter_rad after it, which takes kAheadAfter_s to vanish.
constexpr double kAhead_rad = 13 * M_PI / 180, kAheadAfter_rad = 55 * M_PI / 180;
constexpr double kAhead_s = 3, kAheadAfter_s = 4;

// Rises from 0 at u = 0 to 1 at u = 1, without a jump of speed or acceleration.
double smooth_step(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return u * u * u * (u * (6 * u - 15) + 10);
}

struct OnFloor {
  Vector2d at;      // position, m
  Vector2d left;    // unit vector to the left of the way
  double away_rad;  // yaw of the direction away from the middle of the room
};

// Returns the place in the second half of the walk, `along_m` after the doorway. The first half is the second one
// turned by 180 degrees.
OnFloor second_half(double along_m) {
  const double straight_m = std::sqrt(kMiddle_m * kMiddle_m - kRadius_m * kRadius_m);
  const double touch_rad = M_PI - std::acos(kRadius_m / kMiddle_m);  // as seen from the middle of the room
  if (along_m < straight_m) {
    const Vector2d left(std::cos(touch_rad), std::sin(touch_rad));
    return {along_m * Vector2d(left.y(), -left.x()), left, touch_rad};
  }
  const double turned_rad = std::min((along_m - straight_m) / kRadius_m, kArc_rad);
  const double angle = touch_rad - turned_rad;
  const Vector2d outwards(std::cos(angle), std::sin(angle)), onwards(outwards.y(), -outwards.x());
  const double beyond_m = along_m - straight_m - turned_rad * kRadius_m;
  return {Vector2d(kMiddle_m, 0) + kRadius_m * outwards + beyond_m * onwards, outwards, angle};
}

OnFloor on_floor(double along_m) {
  if (along_m >= 0) return second_half(along_m);
  const OnFloor turned = second_half(-along_m);
  return {-turned.at, turned.left, turned.away_rad - M_PI};
}

class NextRoomPath {
 public:
  NextRoomPath(double seconds, cv::RNG& rng)
      : middle_s_(seconds / 2),
        aside_(rng, slow(seconds)),
        height_(rng, slow(seconds)),
        gaze_(rng, slow(seconds)),
        tilt_(rng, slow(seconds)),
        shake_x_(rng, kFast),
        shake_y_(rng, kFast),
        shake_z_(rng, kFast),
        nod_(rng, kFast),
        shake_yaw_(rng, kFast),
        roll_(rng, kFast) {}

  SE3 at(double t) const {
    const double since_door_s = t - middle_s_;
    const OnFloor floor = on_floor(along_m(since_door_s));
    // The camera wanders neither at the ends nor at the doorway, which is too narrow.
    const double free = smooth_step((middle_s_ - std::abs(since_door_s)) / 2) *
                        smooth_step((std::abs(since_door_s) - kPassage_s / 2) / 3);
    const Vector2d at = floor.at + 0.2 * free * aside_.at(t) * floor.left;
    const Eigen::Vector3d position(at.x() + 0.008 * shake_x_.at(t), at.y() + 0.008 * shake_y_.at(t),
                                   1.45 + 0.15 * height_.at(t) + 0.01 * shake_z_.at(t));
    const double yaw = yaw_rad(since_door_s) + 0.3 * free * gaze_.at(t) + 0.008 * shake_yaw_.at(t);
    return look(position, yaw, -0.10 + 0.18 * tilt_.at(t) + 0.008 * nod_.at(t), 0.02 * roll_.at(t));
  }

 private:
  static inline const std::vector<double> kFast{1.1, 1.9, 3.3};
  static std::vector<double> slow(double seconds) { return {1 / seconds, 2 / seconds, 3 / seconds}; }

  double along_m(double since_door_s) const {
    const double straight_m = std::sqrt(kMiddle_m * kMiddle_m - kRadius_m * kRadius_m);
    const double half_m = straight_m + kArc_rad * kRadius_m + kEnd_m;
    const double pace_m_s = (half_m - kHurry_m / 2) / middle_s_;
    return pace_m_s * since_door_s + kHurry_m * (smooth_step(0.5 + since_door_s / kPassage_s) - 0.5);
  }

  double yaw_rad(double since_door_s) const {
    const double out_s = std::abs(since_door_s) - kPassage_s / 2;  // time outside the passage; negative inside
    const double before = on_floor(std::min(along_m(since_door_s), -1e-9)).away_rad +
                          (since_door_s < 0 ? kAhead_rad * smooth_step(1 - out_s / kAhead_s) : kAhead_rad);
    const double after =
        on_floor(std::max(along_m(since_door_s), 0.0)).away_rad -
        (since_door_s > 0 ? kAheadAfter_rad * smooth_step(1 - out_s / kAheadAfter_s) : kAheadAfter_rad);
    return before + smooth_step(0.5 + since_door_s / kTurn_s) * (after - before);
  }

  double middle_s_;
  Wobble aside_, height_, gaze_, tilt_, shake_x_, shake_y_, shake_z_, nod_, shake_yaw_, roll_;
};

}  // namespace

Walk walk_to_next_room(double seconds, uint64_t seed) {
  cv::RNG rng(seed * 7919 + 29);
  const NextRoomPath path(seconds, rng);
  Walk walk;
  const int samples = static_cast<int>(std::ceil(seconds * kSampleHz)) + 1;
  for (int i = 0; i < samples; ++i) walk.path.add(kStart_s + i / kSampleHz, path.at(i / kSampleHz));
  walk.doorway = Doorway();
  const double at_s = (seconds - kPassage_s) / 2;
  walk.hard = {{HardPassage::Kind::kBlur, at_s, kPassage_s, kBlur},
               {HardPassage::Kind::kDark, at_s, kPassage_s, kDarkness}};
  return walk;
}

}  // namespace rumi::synth
