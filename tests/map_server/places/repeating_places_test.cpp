// SPDX-License-Identifier: BSD-3-Clause
// Places of buildings that repeat must not be joined by looks, and places that are seen again must, also if somebody
// has moved things or stands in the way. A place is made of a building, which equals that of the other place, and of
// things, each a group of points near each other.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <vector>

#include "map_server/places/place_alignment.h"
#include "slam/features/matching.h"
#include "tests/map_server/places/place_scene.h"

namespace rumi::map_server {
namespace {

using Points = std::vector<ScenePoint>;
using Eigen::Vector3d;

constexpr unsigned kSeeds = 50;
constexpr int kThings = 14;
const SubmapKey kA{1, 1}, kB{1, 2};

Points& operator+=(Points& a, const Points& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

Points moved(Points points, const SE3& by) {
  for (ScenePoint& p : points) p.position = by * p.position;
  return points;
}

SE3 shift(double x) { return {Eigen::Quaterniond::Identity(), {x, 0, 0}}; }

// Two submaps, and the similarity that is true if they are of the same place.
struct Pair {
  Submap a, b;
  Sim3 b_from_a;
};

class Builder {
 public:
  explicit Builder(unsigned seed) : scene(seed) {}

  // Points all over the walls, without any thing.
  Points building(int count = 120) { return scene.cloud(count); }
  // A thing about a metre wide, around the origin.
  Points thing() {
    Points points = scene.cloud(28);
    const double wide = scene.uniform(0.35, 0.6), deep = scene.uniform(0.05, 0.4);
    for (ScenePoint& p : points)
      p.position = {scene.uniform(-wide, wide), scene.uniform(-0.45, 0.45), scene.uniform(-deep, deep)};
    return points;
  }
  std::vector<Points> things(int count = kThings) {
    std::vector<Points> all;
    for (int k = 0; k < count; ++k) all.push_back(thing());
    return all;
  }
  // Where the k-th thing stands: in two rows, side by side, at other distances.
  SE3 spot(int k) {
    const double column = k % (kThings / 2) - (kThings / 2 - 1) / 2.0, row = k / (kThings / 2) - 0.5;
    const double z = 4.2 + 0.5 * ((3 * k) % 4);
    return {so3_exp({0, scene.uniform(-0.5, 0.5), 0}), {0.135 * z * column, 0.42 * z * row, z}};
  }
  std::vector<SE3> spots() {
    std::vector<SE3> all;
    for (int k = 0; k < kThings; ++k) all.push_back(spot(k));
    return all;
  }
  static Points furnished(Points building, const std::vector<Points>& things, const std::vector<SE3>& spots) {
    for (size_t k = 0; k < things.size(); ++k) building += moved(things[k], spots[k]);
    return building;
  }
  // Exchanges a share of the things for others, which stand where those stood.
  std::vector<Points> exchanged(std::vector<Points> some, double share) {
    std::vector<size_t> order(some.size());
    for (size_t k = 0; k < order.size(); ++k) order[k] = k;
    std::shuffle(order.begin(), order.end(), rng);
    const size_t others = static_cast<size_t>(std::lround(share * static_cast<double>(some.size())));
    for (size_t k = 0; k < others; ++k) some[order[k]] = thing();
    return some;
  }
  std::vector<SE3> path_b() {
    return scene.path(scene.uniform(-0.4, 0.4), scene.uniform(-0.2, 0.2), scene.uniform(-0.4, 0.4),
                      scene.uniform(-0.1, 0.1));
  }
  Pair pair(const Points& seen_by_a, const Points& seen_by_b, const std::vector<SE3>& path) {
    const Sim3 a_from_world = scene.gauge(1), b_from_world = scene.gauge(std::exp(scene.uniform(-1, 1)));
    Pair pair{scene.submap(kA, seen_by_a, scene.path(0, 0, 0), a_from_world),
              scene.submap(kB, seen_by_b, path, b_from_world), b_from_world * a_from_world.inverse()};
    for (auto& [id, keyframe] : pair.b.keyframes) keyframe.utime_us += 100'000'000;
    for (Submap* submap : {&pair.a, &pair.b})
      for (const auto& [id, keyframe] : submap->keyframes) submap->frames.set({keyframe.utime_us, id, {}, 1});
    return pair;
  }
  Pair pair(const Points& seen_by_a, const Points& seen_by_b) { return pair(seen_by_a, seen_by_b, path_b()); }

  PlaceScene scene;
  std::mt19937 rng{7};
};

// --- Pairs that must not be joined

Pair storeys(unsigned seed, double other) {
  Builder b(seed);
  const Points building = b.building();
  const auto things = b.things();
  const auto spots = b.spots();
  return b.pair(Builder::furnished(building, things, spots),
                Builder::furnished(building, b.exchanged(things, other), spots));
}
// The storeys have nothing in common but the building; some of the things; or half of them.
Pair other_things(unsigned seed) { return storeys(seed, 1); }
Pair some_equal_things(unsigned seed) { return storeys(seed, 0.7); }
Pair half_equal_things(unsigned seed) { return storeys(seed, 0.5); }

// Doors at equal distances, of which several are seen. The other submap is some doors further.
Pair equal_doors(unsigned seed) {
  Builder b(seed);
  Points door = b.thing(), corridor;
  door += moved(b.thing(), shift(0.8));
  const double every_m = b.scene.uniform(1.6, 2.4);
  for (int k = -6; k <= 8; ++k) corridor += moved(door, {so3_exp({0, 0, 0}), {every_m * k, 0, 4}});
  return b.pair(corridor, corridor, b.scene.path(every_m * static_cast<int>(1 + seed % 3), 0, 0));
}

// Only one door is seen, and what hangs beside it is different.
Pair other_numbers(unsigned seed) {
  Builder b(seed);
  Points doors = moved(b.thing(), {so3_exp({0, 0, 0}), {-0.6, 0, 4}});
  doors += moved(b.thing(), {so3_exp({0, 0, 0}), {0.6, 0, 4}});
  doors += b.building(60);
  Points here = doors, there = doors;
  for (const double x : {-1.9, 1.9}) {
    here += moved(b.thing(), {so3_exp({0, 0, 0}), {x, 0.4, 5}});
    there += moved(b.thing(), {so3_exp({0, 0, 0}), {x, -0.4, 5}});
  }
  return b.pair(here, there);
}

// Another side of a square: equal facades, with other things before them, nearer to the camera.
Pair equal_sides(unsigned seed) {
  Builder b(seed);
  Points facade = b.scene.cloud(220);
  for (ScenePoint& p : facade) p.position *= 6 / p.position.z();
  Points here = facade, there = facade;
  for (Points* side : {&here, &there})
    for (int k = 0; k < 7; ++k)
      *side += moved(b.thing(), {so3_exp({0, b.scene.uniform(-0.5, 0.5), 0}),
                                 {b.scene.uniform(-1.5, 1.5), b.scene.uniform(-1, 1), b.scene.uniform(2.6, 4)}});
  return b.pair(here, there);
}

// Another room has the same furniture, but each piece stands elsewhere.
Pair same_furniture(unsigned seed) {
  Builder b(seed);
  const auto things = b.things();
  auto there = things;
  std::shuffle(there.begin(), there.end(), b.rng);
  const auto spots = b.spots();
  return b.pair(Builder::furnished(b.building(), things, spots), Builder::furnished(b.building(), there, b.spots()));
}

// The other submap mixes two equal storeys: every second image is of the first one, the rest of the second one.
Pair mixed_storeys(unsigned seed) {
  Builder b(seed);
  const Points building = b.building();
  const auto things = b.things();
  const auto spots = b.spots();
  const Points here = Builder::furnished(building, things, spots);
  const Points there = Builder::furnished(building, b.exchanged(things, 1), spots);
  Points both = here;
  both += Points(there.begin() + static_cast<std::ptrdiff_t>(building.size()), there.end());
  Pair pair = b.pair(here, both);
  // The k-th keyframe loses what it does not see: the things of the other storey.
  std::map<int, int> storey_of;  // by landmark, told by the descriptor's nearest point
  for (const auto& [id, landmark] : pair.b.landmarks) {
    const Observation& o = landmark.observations.front();
    const Descriptor& d = pair.b.keyframe(o.keyframe_id)->features->descriptors[static_cast<size_t>(o.keypoint_index)];
    for (size_t p = building.size(); p < both.size(); ++p)
      if (hamming_distance(d, both[p].descriptor) < 40) storey_of[id] = p < here.size() ? 1 : 2;
  }
  for (auto& [keyframe_id, keyframe] : pair.b.keyframes) {
    auto features = std::make_shared<Features>(*keyframe.features);
    for (size_t k = 0; k < features->size(); ++k) {
      const auto storey = storey_of.find(keyframe.landmark_ids[k]);
      if (storey == storey_of.end() || storey->second == 1 + keyframe_id % 2) continue;
      features->descriptors[k] = b.scene.descriptor();
      pair.b.remove_observation(keyframe.landmark_ids[k], keyframe_id);
    }
    keyframe.features = features;
  }
  return pair;
}

// --- Pairs that must be joined

Pair seen_again(unsigned seed) { return storeys(seed, 0); }
Pair tidied_up(unsigned seed) { return storeys(seed, 0.2); }

// Somebody stands before the camera, and hides a fourth of what it sees.
Pair somebody_in_the_way(unsigned seed) {
  Builder b(seed);
  const Points here = Builder::furnished(b.building(), b.things(), b.spots());
  const double left = b.scene.uniform(-0.45, 0.2), right = left + 0.22;
  Points there;
  for (const ScenePoint& p : here) {
    const double x = p.position.x() / p.position.z();
    if (x < left || x > right) there.push_back(p);
  }
  for (int k = 0; k < 3; ++k) there += moved(b.thing(), {so3_exp({0, 0, 0}), {2 * (left + 0.11), 0.6 * (k - 1), 2}});
  return b.pair(here, there, b.scene.path(b.scene.uniform(-0.2, 0.2), 0, 0));
}

Pair from_aside(unsigned seed) {
  Builder b(seed);
  const Points here = Builder::furnished(b.building(), b.things(), b.spots());
  const double side = seed % 2 ? 1 : -1;
  return b.pair(here, here, b.scene.path(side * 0.9, 0.1, 0.2, side * 0.12));
}

Pair from_nearer(unsigned seed) {
  Builder b(seed);
  const Points here = Builder::furnished(b.building(), b.things(), b.spots());
  return b.pair(here, here, b.scene.path(0, 0.1, b.scene.uniform(0.7, 1.2)));
}

// Half of the keypoints of the second visit are not those of the first one.
Pair in_other_light(unsigned seed) {
  Builder b(seed);
  const Points here = Builder::furnished(b.building(), b.things(), b.spots());
  Points there = here;
  for (ScenePoint& p : there)
    if (b.scene.uniform(0, 1) < 0.5) p.descriptor = b.scene.descriptor();
  return b.pair(here, there);
}

Pair few_landmarks(unsigned seed) {
  Builder b(seed);
  const Points here = b.building(260);
  return b.pair(here, here);
}

Pair part_in_view(unsigned seed) {
  Builder b(seed);
  const Points here = Builder::furnished(b.building(), b.things(), b.spots());
  return b.pair(here, here, b.scene.path(0, 0, 0, seed % 2 ? 0.35 : -0.35));
}

struct Kind {
  const char* name;
  Pair (*make)(unsigned seed);
};
constexpr Kind kImpossible[] = {{"other things", other_things},           {"some equal things", some_equal_things},
                                {"half equal things", half_equal_things}, {"equal doors", equal_doors},
                                {"other numbers", other_numbers},         {"equal sides", equal_sides},
                                {"same furniture", same_furniture},       {"mixed storeys", mixed_storeys}};
constexpr Kind kPossible[] = {{"seen again", seen_again},          {"tidied up", tidied_up},
                              {"in the way", somebody_in_the_way}, {"from aside", from_aside},
                              {"from nearer", from_nearer},        {"other light", in_other_light},
                              {"few landmarks", few_landmarks},    {"part in view", part_in_view}};

// As PlaceSearch, which is slower: a join needs two alignments of different keyframes that agree. Returns nullopt if no
// two of three do.
std::optional<Sim3> join(const Pair& pair) {
  std::vector<Sim3> accepted;
  int refused = 0;
  for (const int keyframe : {3, 7, 5}) {
    const PlaceAlignment found = align_places(pair.a, keyframe, pair.b, keyframe);
    if (!found.doubt.empty() && ++refused == 2) return std::nullopt;
    if (!found.doubt.empty()) continue;
    for (const Sim3& other : accepted)
      if (found.b_from_a.rotation.angularDistance(other.rotation) < 5 * M_PI / 180 &&
          std::abs(std::log(found.b_from_a.scale / other.scale)) < 0.15)
        return found.b_from_a;
    accepted.push_back(found.b_from_a);
  }
  return std::nullopt;
}

TEST(RepeatingPlaces, HardlyAnyIsJoined) {
  int accepted = 0;
  for (const Kind& kind : kImpossible) {
    int of_kind = 0;
    for (unsigned seed = 1; seed <= kSeeds; ++seed) of_kind += join(kind.make(seed)).has_value();
    std::printf("%-18s %d of %u accepted\n", kind.name, of_kind, kSeeds);
    std::fflush(stdout);
    accepted += of_kind;
  }
  std::printf("impossible joins: %d of 400 accepted\n", accepted);
  // The aim is 0. What is left are the mixed storeys, all 50: no place of theirs lacks anything; and two others.
  EXPECT_LE(accepted, 52);
}

TEST(RepeatingPlaces, AlmostAllThatAreSeenAgainAreJoined) {
  int accepted = 0, wrong = 0;
  for (const Kind& kind : kPossible) {
    int of_kind = 0;
    for (unsigned seed = 1; seed <= kSeeds; ++seed) {
      const Pair pair = kind.make(seed);
      const std::optional<Sim3> b_from_a = join(pair);
      if (!b_from_a) continue;
      ++of_kind;
      wrong += std::abs(std::log(b_from_a->scale / pair.b_from_a.scale)) > 0.05 ||
               b_from_a->rotation.angularDistance(pair.b_from_a.rotation) > 0.02;
    }
    std::printf("%-18s %d of %u accepted\n", kind.name, of_kind, kSeeds);
    std::fflush(stdout);
    accepted += of_kind;
  }
  std::printf("possible joins: %d of 400 accepted, %d of them wrong\n", accepted, wrong);
  EXPECT_EQ(wrong, 0);
  EXPECT_GE(accepted, 396);
}

}  // namespace
}  // namespace rumi::map_server
