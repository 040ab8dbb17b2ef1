// SPDX-License-Identifier: BSD-3-Clause
// Submaps that are empty, or have values that are not finite.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <utility>

#include "tests/map_server/merging/map_builder_fixture.h"

namespace rumi::testing {
namespace {

using SpoiledSubmapsTest = MapBuilderTest;

TEST_F(SpoiledSubmapsTest, NumbersThatAreNonePoisonNothing) {
  const std::pair<const char*, std::function<void()>> cases[] = {
      {"landmarks",
       [&] {
         for (auto& [key, made] : made_)
           for (int id = 0; id < 10; ++id) made.submap.landmark(id)->position.setConstant(id % 2 ? NAN : INFINITY);
       }},
      {"shared pose", [&] { made_[back1_].submap.keyframes.at(2).cam_from_submap.translation.setConstant(NAN); }},
      {"lone pose", [&] { made_[back1_].submap.keyframes.at(8).cam_from_submap.translation.setConstant(NAN); }},
      {"first pose of the anchor",
       [&] { made_[front2_].submap.keyframes.at(0).cam_from_submap.rotation.coeffs().setConstant(NAN); }}};
  const auto whole = made_;
  for (const auto& [name, spoil] : cases) {
    made_ = whole;
    spoil();
    MapMaker maker;
    const BuiltMap map = maker.build({.submaps = submaps()});
    std::vector<Eigen::Vector3d> estimate, truth;
    int infinite = 0;
    for (const auto& [key, placement] : map.placements)
      for (const auto& [utime_us, similarity] : placement.map_from_submap) {
        infinite += !similarity.is_finite();
        const Keyframe* keyframe = nullptr;
        for (const auto& [id, k] : made_[key].submap.keyframes)
          if (k.utime_us == utime_us) keyframe = &k;
        const Eigen::Vector3d center = placement.cam_from_map(*keyframe).center();
        if (!center.allFinite()) continue;
        estimate.push_back(center);
        truth.push_back(images_[image_of(utime_us)].cam_from_world.center());
      }
    const PathError e = path_error(estimate, truth);
    std::printf("%s: %zu submaps, %d similarities are no numbers, ATE of the others %.1f mm\n", name,
                map.placements.size(), infinite, 1000 * e.rmse);
    EXPECT_EQ(infinite, 0) << name;
    EXPECT_EQ(map.placements.size(), 5u) << name;
    EXPECT_LT(e.rmse, 0.04) << name;
  }
}

TEST_F(SpoiledSubmapsTest, EmptyAndBlindSubmapsDoNoHarm) {
  Submap empty, blind = made_[front2_].submap, unseen = made_[front1_].submap;
  empty.key = {kSession, 8};
  blind.key = {kSession, 9};
  unseen.key = {kSession, 10};
  blind.landmarks.clear();
  for (auto& [id, keyframe] : blind.keyframes) keyframe.landmark_ids.assign(keyframe.landmark_ids.size(), kNone);
  for (auto& [id, landmark] : unseen.landmarks) landmark.observations.clear();
  for (auto& [id, keyframe] : unseen.keyframes) keyframe.landmark_ids.assign(keyframe.landmark_ids.size(), kNone);
  Landmark& lonely = made_[back1_].submap.landmarks[99999];
  lonely.id = 99999;
  lonely.position = {1, 2, 3};
  auto all = submaps();
  all[empty.key] = &empty;
  all[blind.key] = &blind;
  all[unseen.key] = &unseen;
  MapMaker maker;
  const BuiltMap map = maker.build({.submaps = all});
  EXPECT_EQ(map.placements.size(), 5u);
  EXPECT_TRUE(finite(map.placements));
  EXPECT_LT(error(map.placements).rmse, 0.04);
  EXPECT_TRUE(map.placements.at(back1_).position_in_map(made_[back1_].submap, lonely).allFinite());
  // These submaps were placed once, but are empty now.
  Placements placed = map.placements;
  placed[empty.key] = {};
  placed[blind.key] = {};
  EXPECT_TRUE(finite(maker.build({.submaps = all, .placed = placed}).placements));
  // A build of only one such submap and a back submap.
  const Submaps no_front = {{empty.key, &empty}, {back1_, &made_[back1_].submap}};
  EXPECT_FALSE(
      maker.build({.submaps = no_front, .placed = {{empty.key, {}}, {back1_, {}}}}).placements.contains(empty.key));
  // A build of only such submaps.
  const Submaps useless = {{empty.key, &empty}, {blind.key, &blind}};
  EXPECT_TRUE(finite(maker.build({.submaps = useless, .placed = {{empty.key, {}}, {blind.key, {}}}}).placements));
}

}  // namespace
}  // namespace rumi::testing
