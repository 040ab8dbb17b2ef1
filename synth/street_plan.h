// SPDX-License-Identifier: BSD-3-Clause
// The map of a town around a route: where houses, fences, trees and other things stand. It depends on the whole route
// and the seed alone, so that every part of a route and every day has the same town.
#pragma once

#include <cstdint>
#include <vector>

#include "synth/street_field.h"
#include "synth/street_style.h"

namespace rumi::synth {

struct House {
  Footprint footprint;  // its corner is the left one of the façade, as seen from the street
  double floor_m = 0;   // height of the ground floor
  double foot_m = 0;    // how far down the walls reach
  double eaves_m = 0;   // from the floor up to the roof
  double ridge_m = 0;   // from the eaves up; 0: flat roof
  int storeys;
  bool shop, remote;  // remote: seen from far away only
  uint64_t number;
};

// A thing at a place; `size` is its height or length in metres, yaw the direction of its front.
struct Place {
  Eigen::Vector2d at;
  double yaw_rad, size_m;
  uint64_t number;
};

// A hedge, fence or wall.
struct Strip {
  enum class Kind { kHedge, kFence, kWall } kind;
  Eigen::Vector2d from, to;
  uint64_t number;
};

// A stretch of the pavement on which a person may walk up and down.
struct Stretch {
  double from_m, to_m;  // along the route
  double left_m;        // of the route
  uint64_t number;
};

struct StreetPlan {
  std::vector<House> houses;
  std::vector<Strip> strips;
  std::vector<Place> trees, lamps, signs, parking;
  std::vector<Place> dashes, zebras, manholes, patches;  // painted on the road
  std::vector<Stretch> walkers;
};

// Marks in the field what has been built.
StreetPlan plan_street(const Route& route, const StreetStyle& style, uint64_t seed, StreetField* field);

}  // namespace rumi::synth
