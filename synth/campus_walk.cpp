// SPDX-License-Identifier: BSD-3-Clause
#include "synth/campus_walk.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "synth/handheld.h"
#include "synth/street_field.h"
#include "synth/street_style.h"

namespace rumi::synth {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kStart_s = 1000;  // not 0, because a time of 0 often means that there is no time
constexpr double kSampleHz = 50;
constexpr double kBlock_m = 31, kJitter_m = 4;  // ways lie on a loose grid
constexpr double kCorner_m = 2.0;               // the robot leaves its way so far before a corner
constexpr double kMaxTurn_radps = 55 * M_PI / 180;
constexpr int kTries = 8000;

// The ways: a grid of places, each joined with its neighbours.
struct Ways {
  int columns, rows;
  std::vector<Vector2d> places;

  std::vector<int> neighbours(int place) const {
    const int x = place % columns, y = place / columns;
    std::vector<int> out;
    if (x > 0) out.push_back(place - 1);
    if (x + 1 < columns) out.push_back(place + 1);
    if (y > 0) out.push_back(place - columns);
    if (y + 1 < rows) out.push_back(place + columns);
    return out;
  }
};

Ways make_ways(double length_m, cv::RNG& rng) {
  // A few more ways than the round is long: what it goes twice, and what it leaves out, is about as much. A grid of n
  // by n places has 2 n (n - 1) ways.
  const double edges = std::max(4.0, 1.2 * length_m / kBlock_m);
  int n = 2;
  while (2 * n * n - 2 * n < edges) ++n;
  Ways ways{.columns = n, .rows = n, .places = {}};
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x)
      ways.places.emplace_back(x * kBlock_m + rng.uniform(-kJitter_m, kJitter_m),
                               y * kBlock_m + rng.uniform(-kJitter_m, kJitter_m));
  return ways;
}

// Returns a round of at least that length. It prefers ways on which it was less often, goes straight on rather than
// around a corner, and never turns back at once.
std::vector<int> make_round(const Ways& ways, double length_m, cv::RNG& rng) {
  std::vector<int> round{rng.uniform(0, static_cast<int>(ways.places.size()))};
  std::map<std::pair<int, int>, int> gone;
  // How much it prefers ways that are new, and going straight on: each round has its own taste.
  const double novelty = rng.uniform(0.0, 1.2), turning = rng.uniform(0.0, 2.0);
  double length = 0;
  while (length < length_m) {
    const int here = round.back(), before = round.size() > 1 ? round[round.size() - 2] : -1;
    int best = -1;
    double least = 1e9;
    for (const int next : ways.neighbours(here)) {
      const double cost = novelty * gone[{std::min(here, next), std::max(here, next)}] + rng.uniform(0.0, 1.4) +
                          (next - here == here - before ? 0 : turning);
      if (next != before && cost < least) {
        least = cost;
        best = next;
      }
    }
    ++gone[{std::min(here, best), std::max(here, best)}];
    length += (ways.places[best] - ways.places[here]).norm();
    round.push_back(best);
  }
  return round;
}

// Counts the places at which the round crosses itself: it goes straight on where it went across before.
int crossings(const Ways& ways, const std::vector<int>& round) {
  int count = 0;
  std::map<std::pair<int, int>, int> straight;  // how often a place was passed along x (1) or y
  for (size_t i = 1; i + 1 < round.size(); ++i) {
    const int step = std::abs(round[i] - round[i - 1]);
    if (std::abs(round[i + 1] - round[i]) != step) continue;
    count += straight[{round[i], step == 1 ? ways.columns : 1}];
    ++straight[{round[i], step}];
  }
  return count;
}

// Counts the ways that were gone in both directions.
int both_ways(const std::vector<int>& round) {
  std::map<std::pair<int, int>, bool> gone;
  int count = 0;
  for (size_t i = 0; i + 1 < round.size(); ++i) {
    if (gone[{round[i + 1], round[i]}] && !gone[{round[i], round[i + 1]}]) ++count;
    gone[{round[i], round[i + 1]}] = true;
  }
  return count;
}

// Returns the round with its corners cut by arcs, as points a few centimetres apart.
std::vector<Vector2d> rounded(const Ways& ways, const std::vector<int>& round) {
  constexpr double kStep_m = 0.02;
  std::vector<Vector2d> points;
  const auto straight = [&](const Vector2d& from, const Vector2d& to) {
    const int n = std::max(1, static_cast<int>((to - from).norm() / kStep_m));
    for (int i = 0; i < n; ++i) points.push_back(from + (to - from) * i / n);
  };
  Vector2d from = ways.places[round[0]];
  for (size_t k = 1; k + 1 < round.size(); ++k) {
    const Vector2d &at = ways.places[round[k]], in = (at - ways.places[round[k - 1]]).normalized(),
                   out = (ways.places[round[k + 1]] - at).normalized();
    const Vector2d begin = at - kCorner_m * in, end = at + kCorner_m * out;
    straight(from, begin);
    // An arc that is tangent to both ways: its points lie between them as those of a circle.
    const double turn = std::acos(std::clamp(in.dot(out), -1.0, 1.0)),
                 side = in.x() * out.y() - in.y() * out.x() > 0 ? 1 : -1;
    if (turn < 1e-3) {
      straight(begin, end);
    } else {
      const double radius = kCorner_m / std::tan(turn / 2);
      const Vector2d centre = begin + side * radius * Vector2d(-in.y(), in.x()), arm = begin - centre;
      const int n = std::max(2, static_cast<int>(radius * turn / kStep_m));
      for (int i = 0; i < n; ++i) points.push_back(centre + Eigen::Rotation2Dd(side * turn * i / n) * arm);
    }
    from = end;
  }
  straight(from, ways.places[round.back()]);
  return points;
}

}  // namespace

CameraPath walk_campus(double seconds, uint64_t seed) {
  const double length_m = seconds * kCampusSpeed_mps + 4;
  cv::RNG rng = rng_of(seed, kCampusChance, 0);
  const Ways ways = make_ways(length_m, rng);
  const double wanted = length_m / 90;  // crossings
  std::vector<int> best;
  double least = 1e9;
  for (int i = 0; i < kTries; ++i) {
    const std::vector<int> round = make_round(ways, length_m, rng);
    const double cost = std::abs(crossings(ways, round) - wanted) + std::max(0, 3 - both_ways(round));
    if (cost < least) {
      least = cost;
      best = round;
    }
  }
  const std::vector<Vector2d> points = rounded(ways, best);
  const Wobble aside(rng, {0.02, 0.05, 0.09});
  CameraPath path;
  double way_m = 0, heading = std::atan2((points[10] - points[0]).y(), (points[10] - points[0]).x());
  size_t k = 0;
  for (int i = 0; i <= static_cast<int>(seconds * kSampleHz); ++i) {
    const double t = i / kSampleHz, go_m = kCampusSpeed_mps / kSampleHz;
    for (way_m += i > 0 ? go_m : 0; k + 12 < points.size() && way_m > (points[k + 1] - points[k]).norm(); ++k)
      way_m -= (points[k + 1] - points[k]).norm();
    const Vector2d ahead = (points[k + 10] - points[k]).normalized();
    const double turn = std::remainder(std::atan2(ahead.y(), ahead.x()) - heading, 2 * M_PI);
    heading += std::clamp(turn, -kMaxTurn_radps / kSampleHz, kMaxTurn_radps / kSampleHz);
    // It keeps to its way only roughly.
    const Vector2d at = points[k] + way_m * ahead + 0.2 * aside.at(t) * Vector2d(-ahead.y(), ahead.x());
    const double rise = 0.6 * (std::sin(at.x() / 41) + std::cos(at.y() / 33));
    path.add(kStart_s + t,
             look({at.x(), at.y(), StreetField::kCameraHeight_m + rise}, heading + 0.02 * aside.at(t + 7), 0, 0));
  }
  return path;
}

}  // namespace rumi::synth
