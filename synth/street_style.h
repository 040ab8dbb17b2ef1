// SPDX-License-Identifier: BSD-3-Clause
// The measures of a town's streets and of a campus' ways, and chance that depends on a place alone.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

namespace rumi::synth {

// Distances are measured on the ground from the nearest point of the camera's path, in metres.
struct StreetStyle {
  double kerb_m, kerb_height_m;     // the road ends here; the pavement is higher by the kerb
  double pavement_m;                // where the pavement ends
  double house_m;                   // nothing of a house is nearer
  double setback_m[2];              // lowest and highest distance of a façade
  double width_m[2], depth_m[2];    // of a house
  int storeys[2];                   // lowest and highest number
  double attached;                  // share of houses that touch the next one
  double gap_m[2];                  // between houses that do not touch
  double fence_m;                   // where hedges and fences stand between the houses
  double lamp_m, lamp_every_m;      // distance of lamp posts, and along the path
  double tree_m[2], tree_every_m;   // distance of trees, and along the path
  double walker_m, walker_every_m;  // distance of the lane of people, and of their stretches along the path
  bool cars;
};

inline constexpr StreetStyle kTown = {.kerb_m = 5.2,
                                      .kerb_height_m = 0.12,
                                      .pavement_m = 7.4,
                                      .house_m = 8.0,
                                      .setback_m = {8.3, 12.5},
                                      .width_m = {6.5, 15},
                                      .depth_m = {8, 12},
                                      .storeys = {2, 4},
                                      .attached = 0.5,
                                      .gap_m = {1.5, 9},
                                      .fence_m = 7.7,
                                      .lamp_m = 5.7,
                                      .lamp_every_m = 27,
                                      .tree_m = {5.8, 7.2},
                                      .tree_every_m = 15,
                                      .walker_m = 6.5,
                                      .walker_every_m = 24,
                                      .cars = true};

inline constexpr StreetStyle kCampus = {.kerb_m = 1.9,
                                        .kerb_height_m = 0.0,
                                        .pavement_m = 2.6,
                                        .house_m = 4.6,
                                        .setback_m = {5.0, 11},
                                        .width_m = {10, 22},
                                        .depth_m = {9, 13},
                                        .storeys = {2, 5},
                                        .attached = 0.1,
                                        .gap_m = {4, 16},
                                        .fence_m = 4.2,
                                        .lamp_m = 3.1,
                                        .lamp_every_m = 16,
                                        .tree_m = {3.4, 8},
                                        .tree_every_m = 8,
                                        .walker_m = 1.4,
                                        .walker_every_m = 30,
                                        .cars = false};

// Returns a generator for one thing of a kind. It depends on nothing else, so that no thing changes the others.
inline cv::RNG rng_of(uint64_t seed, uint64_t kind, uint64_t number) {
  uint64_t z = seed * 0x9e3779b97f4a7c15ull + kind * 0xbf58476d1ce4e5b9ull + number * 0x94d049bb133111ebull + 1;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return cv::RNG(z ^ (z >> 31) ^ 0x5bd1e995);
}

// The kinds of things that rng_of() knows apart.
enum ChanceOf : uint64_t {
  kHouseChance,
  kTownChance,
  kLampChance,
  kTreeChance,
  kSignChance,
  kMarkChance,
  kParkingChance,
  kWalkerChance,
  kTrafficChance,
  kDayChance,
  kPictureChance,
  kGroundChance,
  kSkyChance,
  kCampusChance,
  kShakeChance
};

}  // namespace rumi::synth
