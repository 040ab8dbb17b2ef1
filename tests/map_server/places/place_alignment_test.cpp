// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/places/place_alignment.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>

#include "tests/map_server/places/place_scene.h"

namespace rumi::map_server {
namespace {

constexpr int kMiddle = 5;  // the middle keyframe of a path
const SubmapKey kA{1, 1}, kB{1, 2};

// Two submaps of one world, and the true similarity between them.
struct Pair {
  Submap a, b;
  Sim3 b_from_a;
  std::map<int, int> names_a, names_b;

  PlaceAlignment align(const PlaceAlignmentOptions& options = {}) const {
    return align_places(a, kMiddle, b, kMiddle, options);
  }
  int wrong_landmarks(const PlaceAlignment& alignment) const {
    int wrong = 0;
    for (const LandmarkPair& p : alignment.landmarks) wrong += names_a.at(p.a) != names_b.at(p.b);
    return wrong;
  }
};

Pair make_pair(PlaceScene* scene, const std::vector<ScenePoint>& seen_by_a, const std::vector<ScenePoint>& seen_by_b,
               double scale, const std::vector<SE3>& path_b) {
  Pair pair;
  const Sim3 a_from_world = scene->gauge(1), b_from_world = scene->gauge(scale);
  pair.a = scene->submap(kA, seen_by_a, scene->path(0, 0, 0), a_from_world, &pair.names_a);
  pair.b = scene->submap(kB, seen_by_b, path_b, b_from_world, &pair.names_b);
  pair.b_from_a = b_from_world * a_from_world.inverse();
  return pair;
}

Pair same_place(unsigned seed, double scale) {
  PlaceScene scene(seed);
  const auto points = scene.cloud(700);
  return make_pair(&scene, points, points, scale, scene.path(0.5, 0.1, 0.2, -0.1));
}

// Gives half of the points each other's descriptors, so that there are as many wrong matches as right ones, the same in
// every view.
std::vector<ScenePoint> with_half_confused(std::vector<ScenePoint> points) {
  for (size_t i = 0; i + 2 < points.size(); i += 4) std::swap(points[i].descriptor, points[i + 2].descriptor);
  return points;
}

std::vector<ScenePoint> mirrored(std::vector<ScenePoint> points) {
  for (ScenePoint& p : points) p.position.x() *= -1;
  return points;
}

// Returns points on a poster, `width` units wide and four units away.
std::vector<ScenePoint> poster(PlaceScene* scene, int count, double width) {
  std::vector<ScenePoint> points = scene->cloud(count);
  for (ScenePoint& p : points)
    p.position = {scene->uniform(-0.5, 0.5) * width, scene->uniform(-0.4, 0.4) * width,
                  4 + scene->uniform(-0.02, 0.02)};
  return points;
}

std::vector<ScenePoint> operator+(std::vector<ScenePoint> a, const std::vector<ScenePoint>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

void expect_right(const Pair& pair, const PlaceAlignment& found, const std::string& of) {
  ASSERT_EQ(found.doubt, "") << of;
  EXPECT_NEAR(found.b_from_a.scale / pair.b_from_a.scale, 1, 0.01) << of;
  EXPECT_LT(found.b_from_a.rotation.angularDistance(pair.b_from_a.rotation), 0.3 * M_PI / 180) << of;
  // Compares the positions of landmarks, relative to the unit of a (they are 2 to 8 units away).
  double worst = 0;
  for (const LandmarkPair& p : found.landmarks) {
    const Eigen::Vector3d x = pair.a.landmark(p.a)->position;
    worst = std::max(worst, (found.b_from_a * x - pair.b_from_a * x).norm() / pair.b_from_a.scale);
  }
  EXPECT_LT(worst, 0.05) << of;
  EXPECT_EQ(found.inliers, static_cast<int>(found.landmarks.size()));
  EXPECT_LE(pair.wrong_landmarks(found), found.inliers / 100) << of;
}

TEST(PlaceAlignment, RecoversTheSimilarityAtAnyScale) {
  for (const double scale : {0.2, 0.5, 1.0, 2.0, 5.0}) {
    const Pair pair = same_place(1, scale);
    expect_right(pair, pair.align(), fmt::format("scale {}", scale));
  }
}

TEST(PlaceAlignment, HalfOfTheMatchesMayBeWrong) {
  PlaceScene scene(2);
  const auto points = scene.cloud(700);
  const Pair pair = make_pair(&scene, points, with_half_confused(points), 3, scene.path(0.4, 0.1, 0.2, -0.1));
  const PlaceAlignment found = pair.align();
  EXPECT_LT(found.consensus, 0.6 * found.proposed);
  expect_right(pair, found, "half wrong");
}

TEST(PlaceAlignment, IsTheSameEveryTimeAndBothWays) {
  const Pair pair = same_place(3, 0.7);
  const PlaceAlignment there = pair.align(), again = pair.align();
  EXPECT_EQ(there.landmarks, again.landmarks);
  EXPECT_EQ(there.b_from_a.translation, again.b_from_a.translation);
  const PlaceAlignment back = align_places(pair.b, kMiddle, pair.a, kMiddle);
  ASSERT_EQ(back.doubt, "");
  const Sim3 round_trip = back.b_from_a * there.b_from_a;
  EXPECT_NEAR(round_trip.scale, 1, 0.005);
  EXPECT_LT(round_trip.rotation.angularDistance(Eigen::Quaterniond::Identity()), 0.003);
}

// Returns a wall of equal tiles, each half a unit wide with 12 points. `different_bits`: by how many bits the
// descriptors differ from tile to tile, at most.
std::vector<ScenePoint> tiled_wall(PlaceScene* scene, int first_column, int last_column, int different_bits) {
  const auto tile = scene->cloud(12);
  std::vector<ScenePoint> wall;
  for (int row = -4; row < 4; ++row)
    for (int column = first_column; column < last_column; ++column)
      for (ScenePoint p : tile) {
        p.name = static_cast<int>(wall.size());
        p.position = {0.5 * column + 0.05 * p.position.x(), 0.5 * row + 0.05 * p.position.y(), 4};
        for (int i = 0; i < different_bits; ++i) {
          const int bit = static_cast<int>(scene->uniform(0, 256));
          p.descriptor[bit / 64] ^= uint64_t{1} << (bit % 64);
        }
        wall.push_back(p);
      }
  return wall;
}

TEST(PlaceAlignment, AWallThatRepeatsIsRefused) {
  // A shift by any number of tiles fits as well.
  for (const double shift : {0.0, 0.5, 1.3}) {
    PlaceScene scene(4);
    const auto wall = tiled_wall(&scene, -8, 8, 0);
    const Pair pair = make_pair(&scene, wall, wall, 1, scene.path(shift, 0, 0));
    EXPECT_NE(pair.align().doubt, "") << shift;
  }
}

TEST(PlaceAlignment, AWallThatAlmostRepeatsIsNeverJoinedATileOff) {
  for (const int bits : {5, 10, 20, 40, 60}) {
    PlaceScene scene(40);
    const auto wall = tiled_wall(&scene, -16, 16, bits);
    const Pair apart = make_pair(&scene, wall, wall, 1, scene.path(6, 0, 0));
    EXPECT_NE(apart.align().doubt, "") << bits;
    const Pair near = make_pair(&scene, wall, wall, 1, scene.path(0.5, 0, 0));
    const PlaceAlignment found = near.align();
    if (found.doubt.empty()) expect_right(near, found, fmt::format("{} bits", bits));
  }
}

TEST(PlaceAlignment, EveryThresholdRefusesWithItsNumbers) {
  const Pair pair = same_place(20, 1);
  ASSERT_EQ(pair.align().doubt, "");
  const auto refused = [&](auto change, const char* words) {
    PlaceAlignmentOptions options;
    change(&options);
    const std::string doubt = pair.align(options).doubt;
    EXPECT_NE(doubt.find(words), std::string::npos) << doubt;
    EXPECT_NE(doubt.find_first_of("0123456789"), std::string::npos) << doubt;
  };
  using O = PlaceAlignmentOptions;
  refused([](O* o) { o->min_proposed = 10'000; }, "look alike, 10000 wanted");
  refused([](O* o) { o->min_consensus = 10'000; }, "agree on a similarity, 10000 wanted");
  refused([](O* o) { o->min_consensus_ratio = 1.1; }, "agree on a similarity");
  refused([](O* o) { o->min_inliers = 10'000; }, "landmarks agree, 10000 wanted");
  refused([](O* o) { o->min_inlier_ratio = 1.1; }, "found by projection agree");
  refused([](O* o) { o->min_found_ratio = 1.1; }, "that should be in view");
  refused([](O* o) { o->min_cells = 49; }, "of 48 cells of an image, 49 wanted");
  refused([](O* o) { o->min_extent_ratio = 5; }, "of its distance, 5 wanted");
  refused([](O* o) { o->max_sigma_rotation_deg = 1e-6; }, "known to");
  refused([](O* o) { o->max_sigma_log_scale = 1e-6; }, "known to");
  refused([](O* o) { o->max_sigma_translation = 1e-6; }, "known to");
  refused([](O* o) { o->min_witness_found = 10'000; }, "further keyframes");
  refused([](O* o) { o->min_witness_ratio = 1.1; }, "further keyframes");
  refused([](O* o) { o->min_witnesses = 7; }, "further keyframes");
  refused([](O* o) { o->max_silent_ratio = -1; }, "hardly any is seen where it should be");
}

TEST(PlaceAlignment, TwoThatExplainAsMuchAreRefused) {
  // Half of the points that b sees fit one similarity, the other half another.
  PlaceScene scene(5);
  const auto points = scene.cloud(600);
  std::vector<ScenePoint> torn = points;
  for (size_t i = 0; i < torn.size(); i += 2) torn[i].position += Eigen::Vector3d(0.5, 0, 0.3);
  const PlaceAlignment found = make_pair(&scene, points, torn, 1, scene.path(0.2, 0, 0)).align();
  EXPECT_NE(found.doubt.find("something repeats"), std::string::npos) << found.doubt;
}

TEST(PlaceAlignment, TheMirrorImageIsRefused) {
  PlaceScene scene(6);
  const auto points = scene.cloud(700);
  const PlaceAlignment found = make_pair(&scene, points, mirrored(points), 1, scene.path(0.2, 0, 0)).align();
  EXPECT_GT(found.proposed, 100);
  EXPECT_NE(found.doubt, "");
}

TEST(PlaceAlignment, ThePosterInTwoRoomsIsRefused) {
  for (const double width : {0.5, 1.2, 4.0}) {  // the widest poster fills the image
    PlaceScene scene(7);
    const auto shared = poster(&scene, 60, width);
    const auto room_a = scene.cloud(500), room_b = scene.cloud(500);
    const PlaceAlignment found = make_pair(&scene, shared + room_a, shared + room_b, 1, scene.path(0.2, 0, 0)).align();
    EXPECT_GT(found.inliers, 30) << found.doubt;
    EXPECT_NE(found.doubt, "") << width;
  }
}

TEST(PlaceAlignment, TooLittleIsRefusedWithTheNumbers) {
  PlaceScene scene(8);
  const auto few = scene.cloud(10);
  const PlaceAlignment little = make_pair(&scene, few, few, 1, scene.path(0.2, 0, 0)).align();
  EXPECT_EQ(little.doubt, fmt::format("{} landmarks look alike, 15 wanted", little.proposed));
  EXPECT_TRUE(little.landmarks.empty());

  const auto one = scene.cloud(500), other = scene.cloud(500);
  EXPECT_NE(make_pair(&scene, one, other, 1, scene.path(0.2, 0, 0)).align().doubt, "");
}

TEST(PlaceAlignment, KeyframesThatHadNoPartInItMustBearItOut) {
  Pair pair = same_place(9, 1);
  ASSERT_EQ(pair.align().doubt, "");
  PlaceAlignmentOptions options;
  options.witnesses = 0;
  EXPECT_EQ(pair.align(options).doubt, "0 of 0 and 0 of 0 further keyframes of the two places bear it out, 2 wanted");

  // All further keyframes of b show something else.
  const PlacePair places = gather_places(pair.a, kMiddle, pair.b, kMiddle, PlaceAlignmentOptions().neighbours, 100);
  PlaceScene scene(10);
  for (const PlaceView& witness : places.b.witnesses) {
    Keyframe& keyframe = *pair.b.keyframe(witness.keyframe->id);
    auto other = std::make_shared<Features>(*keyframe.features);
    for (Descriptor& d : other->descriptors) d = scene.descriptor();
    keyframe.features = other;
  }
  const PlaceAlignment found = pair.align();
  EXPECT_NE(found.doubt.find("further keyframes"), std::string::npos) << found.doubt;
  EXPECT_EQ(found.witnesses_b, 0);
  EXPECT_GE(found.witnesses_a, 2);
}

TEST(PlaceAlignment, WhereTheKeyframesThemselvesShowNothingNobodyElseIsAsked) {
  Pair pair = same_place(9, 1);
  PlaceScene scene(10);
  for (Submap* submap : {&pair.a, &pair.b}) {
    Keyframe& keyframe = *submap->keyframe(kMiddle);
    auto other = std::make_shared<Features>(*keyframe.features);
    for (Descriptor& d : other->descriptors) d = scene.descriptor();
    keyframe.features = other;
  }
  EXPECT_EQ(pair.align().doubt, "0 landmarks look alike, 15 wanted");
}

TEST(PlaceAlignment, WhatIsNotFiniteIsLeftOut) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  Pair pair = same_place(11, 2);
  for (auto& [id, landmark] : pair.a.landmarks)
    if (id % 5 == 0) landmark.position.y() = kNan;
  for (auto& [id, landmark] : pair.b.landmarks)
    if (id % 7 == 0) landmark.position.x() = std::numeric_limits<double>::infinity();
  pair.b.keyframe(2)->cam_from_submap.translation.z() = kNan;
  expect_right(pair, pair.align(), "a fifth not finite");
  const PlacePair places = gather_places(pair.a, kMiddle, pair.b, kMiddle, 4, 6);
  for (const PlaceNeighbourhood* place : {&places.a, &places.b})
    for (const PlaceLandmark& landmark : place->landmarks) EXPECT_TRUE(landmark.position.allFinite());

  for (auto& [id, landmark] : pair.a.landmarks) landmark.position.x() = kNan;
  EXPECT_NE(pair.align().doubt, "");
  pair.b.keyframe(kMiddle)->cam_from_submap.translation.z() = kNan;
  EXPECT_NE(pair.align().doubt.find("keyframe 5 of submap 2"), std::string::npos);
}

TEST(PlaceAlignment, SaysWhatIsMissing) {
  Pair pair = same_place(12, 1);
  EXPECT_NE(align_places(pair.a, 99, pair.b, kMiddle).doubt.find("keyframe 99 of submap 1"), std::string::npos);
  auto bare = std::make_shared<Features>(*pair.a.keyframe(kMiddle)->features);
  bare->undistorted.clear();
  pair.a.keyframe(kMiddle)->features = bare;
  EXPECT_NE(pair.align().doubt.find("keyframe 5 of submap 1"), std::string::npos);
  EXPECT_NE(align_places(Submap(), 1, Submap(), 1).doubt, "");
}

// Returns a submap that sees a's part first and b's part later, after a drift.
Submap joined(const Pair& pair) {
  constexpr int kKeyframes = 100, kLandmarks = 100'000;
  Submap s = pair.a;
  for (const auto& [id, landmark] : pair.b.landmarks) {
    Landmark& copy = s.landmarks[id + kLandmarks] = landmark;
    copy.id = id + kLandmarks;
    for (Observation& o : copy.observations) o.keyframe_id += kKeyframes;
  }
  for (const auto& [id, keyframe] : pair.b.keyframes) {
    Keyframe& copy = s.keyframes[id + kKeyframes] = keyframe;
    copy.id = id + kKeyframes;
    for (int& landmark : copy.landmark_ids)
      if (landmark != kNone) landmark += kLandmarks;
  }
  return s;
}

TEST(PlaceAlignment, ALoopOfOneSubmap) {
  const Pair pair = same_place(13, 1.3);
  Submap loop = joined(pair);
  const PlaceAlignment found = align_places(loop, kMiddle, loop, kMiddle + 100);
  ASSERT_EQ(found.doubt, "");
  EXPECT_NEAR(found.b_from_a.scale, pair.b_from_a.scale, 0.01);
  for (const LandmarkPair& p : found.landmarks) {
    EXPECT_LT(p.a, 100'000);
    EXPECT_GT(p.b, 100'000);
  }
  // Places that share landmarks are refused as a loop: they prove nothing new.
  EXPECT_NE(align_places(loop, kMiddle, loop, kMiddle + 1).doubt.find("share landmarks already"), std::string::npos);
  EXPECT_NE(align_places(loop, kMiddle, loop, kMiddle).doubt, "");
  // A single landmark that both keyframes observe is enough.
  for (const auto& [id, landmark] : loop.landmarks) {
    const auto sees = [&](int keyframe) {
      const auto& ids = loop.keyframe(keyframe)->landmark_ids;
      return std::find(ids.begin(), ids.end(), id) != ids.end();
    };
    if (!sees(kMiddle)) continue;
    loop.add_observation(id, kMiddle + 100, 0);
    break;
  }
  EXPECT_NE(align_places(loop, kMiddle, loop, kMiddle + 100).doubt.find("share landmarks already"), std::string::npos);
}

// Returns the first landmark, from `first_id` on, that this keyframe does not observe.
int landmark_unseen_by(const Submap& submap, int keyframe, int first_id) {
  for (auto it = submap.landmarks.lower_bound(first_id); it != submap.landmarks.end(); ++it) {
    const auto& seen = it->second.observations;
    if (std::none_of(seen.begin(), seen.end(), [&](const Observation& o) { return o.keyframe_id == keyframe; }))
      return it->first;
  }
  return kNone;
}

TEST(PlaceAlignment, TheTwoPlacesOfALoopHaveNothingInCommon) {
  const Pair pair = same_place(14, 1);
  Submap loop = joined(pair);
  // Keyframe 9 observes landmarks of both places.
  Keyframe& bridge = *loop.keyframe(9);
  for (size_t k = 0; k < bridge.landmark_ids.size(); ++k) {
    const int beyond = loop.keyframe(kMiddle + 100)->landmark_ids[k];
    if (bridge.landmark_ids[k] == kNone && beyond != kNone) loop.add_observation(beyond, 9, static_cast<int>(k));
  }
  // One landmark of a's place is fused with one of b's, although the middle keyframes of the two places do not observe
  // them.
  const int in_a = landmark_unseen_by(loop, kMiddle, 0), in_b = landmark_unseen_by(loop, kMiddle + 100, 100'000);
  loop.fuse_landmarks(in_a, in_b);

  const PlacePair places = gather_places(loop, kMiddle, loop, kMiddle + 100, 4, 100);
  ASSERT_EQ(places.doubt, "");
  std::set<int> keyframes, landmarks;
  for (const PlaceNeighbourhood* place : {&places.a, &places.b}) {
    for (const PlaceView& view : place->views) EXPECT_TRUE(keyframes.insert(view.keyframe->id).second);
    for (const PlaceView& view : place->witnesses) EXPECT_TRUE(keyframes.insert(view.keyframe->id).second);
    for (const PlaceLandmark& landmark : place->landmarks) EXPECT_TRUE(landmarks.insert(landmark.id).second);
  }
  EXPECT_EQ(keyframes.size(), 17u);
  EXPECT_FALSE(keyframes.contains(9));
  EXPECT_FALSE(landmarks.contains(in_a));
  EXPECT_EQ(align_places(loop, kMiddle, loop, kMiddle + 100).doubt, "");
}

TEST(PlaceAlignment, AHundredPlacesSeenTwiceAreAccepted) {
  for (unsigned seed = 100; seed < 200; ++seed) {
    PlaceScene scene(seed);
    const auto points = scene.cloud(500);
    const double scale = std::exp(scene.uniform(std::log(0.2), std::log(5)));
    const auto path_b = scene.path(scene.uniform(-0.6, 0.6), scene.uniform(-0.3, 0.3), scene.uniform(-0.5, 0.5),
                                   scene.uniform(-0.15, 0.15));
    const Pair pair = make_pair(&scene, points, seed % 2 ? points : with_half_confused(points), scale, path_b);
    expect_right(pair, pair.align(), fmt::format("seed {}", seed));
  }
}

TEST(PlaceAlignment, AHundredPlacesThatAreNotTheSameAreRefused) {
  for (unsigned seed = 200; seed < 300; ++seed) {
    PlaceScene scene(seed);
    const auto room_a = scene.cloud(400), room_b = scene.cloud(400), some = scene.cloud(100);
    const auto path_b = scene.path(scene.uniform(-0.3, 0.3), scene.uniform(-0.2, 0.2), scene.uniform(-0.3, 0.3));
    const auto seen = [&]() -> std::pair<std::vector<ScenePoint>, std::vector<ScenePoint>> {
      switch (seed % 4) {
        case 0:
          return {room_a, room_b};
        case 1:
          return {room_a, mirrored(room_a)};
        case 2: {
          const auto thing = poster(&scene, 60, scene.uniform(0.3, 4));
          return {room_a + thing, room_b + thing};
        }
        default: {  // some of the same points at other positions
          auto moved = some;
          for (ScenePoint& p : moved) p.position = scene.cloud(1)[0].position;
          return {room_a + some, room_b + moved};
        }
      }
    }();
    const PlaceAlignment found = make_pair(&scene, seen.first, seen.second, 1, path_b).align();
    EXPECT_NE(found.doubt, "") << seed;
  }
}

}  // namespace
}  // namespace rumi::map_server
