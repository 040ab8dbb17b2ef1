// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/merging/map_builder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>

#include "tests/map_server/merging/map_builder_fixture.h"
#include "tests/map_server/synthetic_chain.h"

namespace rumi::testing {
namespace {

// The submaps have another pyramid: with the usual one, observations would get wrong weights.
class OfAnotherPyramid : public MapBuilderTest {
 protected:
  OfAnotherPyramid() : MapBuilderTest(0.001, {4, 1.5}) {}
};

TEST_F(OfAnotherPyramid, JoinsAChainAndWeighsObservationsAsTheyWereMade) {
  const auto rmse_of = [this](const Pyramid& pyramid) {
    for (auto& [key, made] : made_) made.submap.pyramid = pyramid;
    MapMaker maker;
    const BuiltMap map = maker.build({.submaps = submaps()});
    const PathError e = error(map.placements);
    print("another pyramid", map, e);
    EXPECT_EQ(map.placements.size(), 5u);
    EXPECT_LT(e.rmse, 0.04);
    return map.report.rmse;
  };
  const double right = rmse_of(pyramid_), wrong = rmse_of({8, 1.2});
  EXPECT_NEAR(right, 0.5 * std::sqrt(2), 0.1) << "the noise of the keypoints in x and y";
  EXPECT_GT(wrong, right + 0.1);
}

TEST_F(MapBuilderTest, JoinsAChain) {
  MapMaker maker;
  maker.find({.submaps = submaps()});
  int same_images = 0;
  for (const Link& link : maker.graph().links()) {
    if (link.kind != Link::Kind::kSameImages) continue;
    EXPECT_EQ(link.doubt, "");
    ++same_images;
  }
  EXPECT_EQ(same_images, 4);
  const BuiltMap map = maker.build({.submaps = submaps()});
  const PathError e = error(map.placements);
  print("chain", map, e);
  EXPECT_EQ(map.placements.size(), 5u);
  EXPECT_LT(e.rmse, 0.04);
  EXPECT_LT(e.worst, 0.1);
  EXPECT_TRUE(finite(map.placements));
}

// A map that was not adjusted to its end lies as the graph has bent it.
TEST_F(MapBuilderTest, JoinsAChainEvenIfThereIsNoTimeToAdjustIt) {
  const std::atomic<bool> enough = true;
  MapMaker maker;
  const BuiltMap map = maker.build({.submaps = submaps(), .enough = &enough});
  const PathError e = error(map.placements);
  print("in no time", map, e);
  EXPECT_EQ(map.placements.size(), 5u);
  EXPECT_EQ(map.report.observed, 0) << "nothing was searched for";
  EXPECT_LT(e.rmse, 0.1);
  EXPECT_TRUE(finite(map.placements));
}

TEST_F(MapBuilderTest, ABackSubmapAloneIsTheMapAndStaysWhereItIsWhenAFrontOneJoinsIt) {
  MapMaker maker;
  const auto alone = submaps({back1_}), both = submaps({front1_, back1_});
  const BuiltMap first = maker.build({.submaps = alone});
  ASSERT_EQ(first.placements.size(), 1u);
  EXPECT_LT(error(first.placements).rmse, 0.02);
  const Sim3 before = first.placements.at(back1_).map_from_submap.begin()->second;

  const BuiltMap second = maker.build({.submaps = both, .placed = first.placements});
  ASSERT_EQ(second.placements.size(), 2u);
  EXPECT_LT(error(second.placements).rmse, 0.04);
  const Sim3 after = second.placements.at(back1_).map_from_submap.begin()->second;
  EXPECT_NEAR(after.scale, before.scale, 1e-9);
  EXPECT_LT((after.translation - before.translation).norm(), 1e-9);
}

TEST_F(MapBuilderTest, OfWhatDoesNotHangTogetherTheMostFramesAreTheMap) {
  MapMaker maker;
  add(front1_, 0, 20, 0);
  const auto apart = submaps({front1_, back2_});  // no image in common
  const BuiltMap map = maker.build({.submaps = apart});
  EXPECT_EQ(map.placements.size(), 1u);
  EXPECT_TRUE(map.placements.contains(back2_));
}

void expect_same(const BuiltMap& a, const BuiltMap& b) {
  EXPECT_EQ(a.graph.links(), b.graph.links());
  ASSERT_EQ(a.placements.size(), b.placements.size());
  for (const auto& [key, placement] : a.placements) EXPECT_TRUE(same_place(placement, b.placements.at(key)));
}

TEST_F(MapBuilderTest, EqualInputGivesAnEqualMapToTheBit) {
  MapMaker one, other;
  const BuildInput input{.submaps = submaps()};
  const BuiltMap a = one.build(input), b = other.build(input), again = one.build(input);
  ASSERT_EQ(a.placements.size(), 5u);
  expect_same(a, b);
  expect_same(a, again);
}

// One build throws, and one is cancelled.
TEST_F(MapBuilderTest, WhatComesToNothingLeavesAllAsItWas) {
  const BuildInput some{.submaps = submaps({front1_, back1_, front2_})};
  LinkFinder finder({});
  const MapBuilder builder({});
  const BuiltMap first = builder.build(finder.find({}, some), some);
  const BuildInput next{.submaps = submaps(), .placed = first.placements};

  Submap broken = made_.at(back2_).submap;
  break_submap(&broken);
  BuildInput bad = next;
  bad.submaps[back2_] = &broken;
  EXPECT_ANY_THROW(builder.build(finder.find(first.graph, bad), bad));
  const std::atomic<bool> cancel = true;
  BuildInput cancelled = next;
  cancelled.cancel = &cancel;
  EXPECT_TRUE(builder.build(finder.find(first.graph, cancelled), cancelled).placements.empty());

  MapMaker undisturbed;
  undisturbed.build(some);
  const BuiltMap expected = undisturbed.build(next);
  ASSERT_EQ(expected.placements.size(), 5u);
  expect_same(builder.build(finder.find(first.graph, next), next), expected);
}

// Submaps that are placed already stay in the map, whatever comes later, unless a larger group takes its place.
TEST_F(MapBuilderTest, InAnyOrderOfArrival) {
  std::vector<SubmapKey> order = {front1_, back1_, front2_, back2_, front3_};
  std::sort(order.begin(), order.end());
  int number = 0;
  double worst_m = 0;
  do {
    if (number++ % 40 != 3) continue;  // tests 3 of the 120 orders
    MapMaker maker;
    std::vector<SubmapKey> here;
    Placements placed;
    for (const SubmapKey& key : order) {
      here.push_back(key);
      const BuiltMap map = maker.build({.submaps = submaps(here), .placed = placed});
      if (map.placements.empty()) continue;
      // If another group has more frames, it replaces the map as a whole.
      const bool is_kept = placed.empty() || map.placements.contains(placed.begin()->first);
      for (const auto& [member, placement] : placed) EXPECT_EQ(map.placements.contains(member), is_kept) << member.id;
      EXPECT_TRUE(is_kept || frames_of(map.placements) > frames_of(placed));
      placed = map.placements;
    }
    EXPECT_EQ(placed.size(), 5u);
    const PathError e = error(placed);
    worst_m = std::max(worst_m, e.rmse);
    EXPECT_LT(e.rmse, 0.04) << number;
  } while (std::next_permutation(order.begin(), order.end()));
  std::printf("any order: ATE %.1f mm at most\n", 1000 * worst_m);
}

TEST_F(MapBuilderTest, RepeatedCallsKeepTheGaugeAndTheMap) {
  MapMaker maker;
  Placements placed = maker.build({.submaps = submaps()}).placements;
  const SubmapKey anchor = front1_;
  const Submap& submap = made_[anchor].submap;
  const SE3 at_first = placed[anchor].cam_from_map(submap.keyframes.at(0));
  const double scale_at_first = placed[anchor].at(submap.keyframes.at(0).utime_us).scale;
  Placements first = placed;
  double moved = 0;
  for (int round = 0; round < 4; ++round) {
    const BuiltMap map = maker.build({.submaps = submaps(), .placed = placed});
    moved = 0;
    for (const auto& [key, placement] : map.placements)
      for (const auto& [id, keyframe] : made_[key].submap.keyframes)
        moved = std::max(
            moved, (placement.cam_from_map(keyframe).center() - placed[key].cam_from_map(keyframe).center()).norm() /
                       scale_at_first / made_[anchor].submap_from_world.scale);
    print("again", map, error(map.placements));
    std::printf("   moved by %.2f mm at most\n", 1000 * moved);
    placed = map.placements;
    const SE3 now = placed[anchor].cam_from_map(submap.keyframes.at(0));
    EXPECT_LT((now.center() - at_first.center()).norm(), 1e-6 * made_[anchor].submap_from_world.scale);
    EXPECT_LT(rotation_error_deg(now, at_first), 1e-4);
  }
  EXPECT_LT(moved, 0.01);
  EXPECT_LT(error(placed).rmse, 0.04);
}

// The map is larger than the limit for a weld.
TEST_F(MapBuilderTest, AWeldMovesWhatIsAroundWhatIsNewOnly) {
  MapBuilderOptions options;
  options.arrangement.weld_keyframes = 20;
  MapMaker maker(options);
  const auto some = submaps({front1_, back1_, front2_, back2_});
  Placements placed = maker.build({.submaps = some, .scope = BuildScope::kWeld}).placements;
  ASSERT_EQ(placed.size(), 4u);
  BuiltMap map = maker.build({.submaps = submaps(), .scope = BuildScope::kWeld, .placed = placed});
  ASSERT_TRUE(map.placements.contains(front3_));
  EXPECT_FALSE(map.placements.contains(front1_)) << "far away";
  EXPECT_EQ(map.placements.size() + map.unmoved.size(), 5u);
  EXPECT_EQ(map.report.members, 5);
  EXPECT_TRUE(same_place(map.placements.at(back2_), placed.at(back2_))) << "the rest hangs on it";
  for (const SubmapKey& key : map.unmoved) EXPECT_TRUE(map.placements.try_emplace(key, placed.at(key)).second);
  print("welded", map, error(map.placements));
  EXPECT_LT(error(map.placements).rmse, 0.08);
  // Nothing is new, but the whole map is adjusted when that is due.
  const BuiltMap all = maker.build({.submaps = submaps(), .placed = map.placements});
  print("adjusted", all, error(all.placements));
  EXPECT_EQ(all.placements.size(), 5u);
  EXPECT_LT(error(all.placements).rmse, 0.04);
}

TEST_F(MapBuilderTest, AnUnlinkedSubmapStaysOut) {
  MapMaker maker;
  const auto some = submaps({front1_, back1_, front2_, front3_});
  const BuiltMap map = maker.build({.submaps = some});
  EXPECT_EQ(map.placements.size(), 3u);
  EXPECT_FALSE(map.placements.contains(front3_));
  const auto alone = submaps({front1_, front3_});
  MapMaker other;
  other.find({.submaps = alone});
  for (const Link& link : other.graph().links()) EXPECT_FALSE(link.accepted());
  EXPECT_EQ(other.build({.submaps = alone}).placements.size(), 1u);
  EXPECT_TRUE(MapMaker().build({}).placements.empty());
}

TEST_F(MapBuilderTest, ASubmapThatIsTheWholeMapIsAdjustedToo) {
  add(front1_, 0, 99, 0.003);
  const auto alone = submaps({front1_});
  MapMaker maker;
  EXPECT_TRUE(maker.build({.submaps = alone, .scope = BuildScope::kWeld}).placements.empty()) << "nothing was joined";
  const BuiltMap map = maker.build({.submaps = alone});
  ASSERT_EQ(map.placements.size(), 1u);
  const PathError before = error({{front1_, Placement()}}), after = error(map.placements);
  print("alone, before", {}, before);
  print("alone, adjusted", map, after);
  EXPECT_LT(after.rmse, 0.5 * before.rmse);
}

TEST_F(MapBuilderTest, ASubmapThatGrows) {
  const SyntheticSubmap whole = made_[front3_];
  SubmapRecipe half = recipes_[front3_];
  half.last = 130;
  made_[front3_] = make_submap(world_, images_, half);
  MapMaker maker;
  Placements placed = maker.build({.submaps = submaps()}).placements;
  ASSERT_EQ(placed.size(), 5u);
  made_[front3_] = whole;
  made_[front3_].submap.revision = 2;
  EXPECT_LT(error(placed).rmse, 0.06);  // new keyframes follow the last keyframe that is placed
  const BuiltMap map = maker.build({.submaps = submaps(), .placed = placed});
  print("grown", map, error(map.placements));
  EXPECT_EQ(map.placements.at(front3_).map_from_submap.size(), whole.submap.keyframes.size());
  EXPECT_LT(error(map.placements).rmse, 0.04);
}

TEST_F(MapBuilderTest, AMemberThatDisappears) {
  MapMaker maker;
  const Placements placed = maker.build({.submaps = submaps()}).placements;
  for (const SubmapKey& gone : {back2_, front3_, front1_}) {
    auto left = submaps();
    left.erase(gone);
    const BuiltMap map = maker.build({.submaps = left, .placed = placed});
    EXPECT_FALSE(map.placements.contains(gone));
    EXPECT_EQ(map.placements.size(), 4u);  // the other submaps stay placed
    EXPECT_LT(error(map.placements).rmse, 0.04);
    MapMaker fresh;
    EXPECT_LT(fresh.build({.submaps = left}).placements.size(), 5u);
  }
}

// Another run of front_tracker on the same images: recorded by two processes, or replayed into the same map.
TEST_F(MapBuilderTest, TwoSessions) {
  SubmapRecipe other = recipes_[front2_];
  other.key = {kSession + 1, 1};
  other.first = 60;
  other.last = 140;
  other.seed = 99;
  other.distortion = {};
  other.submap_from_world = random_gauge(123);
  made_[other.key] = make_submap(world_, images_, other);
  SubmapRecipe later = other;
  later.key = {kSession + 2, 1};  // it shows another room
  const World elsewhere = make_room(2);
  const auto later_images = film(elsewhere, walk_round(150), {.most_keypoints = 150, .first_utime_us = 50'000'000'000});
  const auto apart = make_submap(elsewhere, later_images, later);
  auto all = submaps();
  all[later.key] = &apart.submap;
  MapMaker maker;
  const BuiltMap map = maker.build({.submaps = all});
  print("two sessions", map, error(map.placements));
  EXPECT_EQ(map.placements.size(), 6u);
  EXPECT_FALSE(map.placements.contains(later.key));
  EXPECT_LT(error(map.placements).rmse, 0.04);
}

}  // namespace
}  // namespace rumi::testing
