// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/merging/map_culling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "tests/map_server/merging/map_maker.h"
#include "tests/map_server/place_map.h"
#include "tests/map_server/synthetic_chain.h"
#include "tests/map_server/test_atlas.h"

namespace rumi::testing {
using namespace rumi::map_server;
namespace {

constexpr SubmapKey kFront1 = Chain::kFront1, kBack1 = Chain::kBack1, kBack2 = Chain::kBack2;

class MapCullingTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { chain_ = new Chain; }
  static void TearDownTestSuite() { delete chain_; }
  MapCullingTest() {
    for (const SubmapKey key : {kFront1, kBack1, Chain::kFront2, kBack2, Chain::kFront3})
      put(chain_->submap(key), &atlas_);
  }
  Submaps submaps() const {
    Submaps submaps;
    for (const auto& [key, owner] : atlas_.submaps()) submaps[key] = &owner.submap;
    return submaps;
  }
  BuiltMap build(MapMaker* maker) {
    Placements placed;
    for (const auto& [key, owner] : atlas_.submaps())
      if (owner.placement.revision > 0) placed[key] = owner.placement;
    BuiltMap built = maker->build({.submaps = submaps(), .placed = placed});
    for (const auto& [key, submap] : built.culled) put(*submap, &atlas_);
    testing::place_map(&atlas_, built.placements);
    return built;
  }
  size_t keyframes(SubmapKey key) const { return atlas_.find(key)->submap.keyframes.size(); }

  static Chain* chain_;
  Atlas atlas_;
};
Chain* MapCullingTest::chain_ = nullptr;

TEST_F(MapCullingTest, FourOfTheImagesInCommonHoldTwoTogether) {
  MapMaker maker;
  maker.find({.submaps = submaps()});
  const CommonImages common = common_images(submaps(), maker.graph());
  size_t joints = 0;
  for (const LinkEdge* edge : maker.graph().edges()) joints += edge->joints.size();
  EXPECT_EQ(common.doubled.size(), joints) << "all that agree";
  EXPECT_EQ(common.needed.at(kFront1).size(), 4u) << "spread over those of one other";
  EXPECT_EQ(common.needed.at(kBack1).size(), 8u) << "of two others";
}

TEST_F(MapCullingTest, BackSubmapsLoseWhatTheMapCanDoWithout) {
  MapBuilderOptions without;
  without.culling.enabled = false;
  MapMaker uncut(without), culling;
  Atlas whole = atlas_;
  const BuiltMap expected = uncut.build({.submaps = submaps()});
  EXPECT_TRUE(expected.culled.empty());
  testing::place_map(&whole, expected.placements);

  const BuiltMap built = build(&culling);
  EXPECT_EQ(built.culled.size(), 2u);
  for (const SubmapKey key : {kBack1, kBack2}) {
    EXPECT_LT(keyframes(key), whole.find(key)->submap.keyframes.size());
    EXPECT_EQ(built.placements.at(key).map_from_submap.size(), keyframes(key));
    for (const auto& [id, position] : built.placements.at(key).landmarks)
      EXPECT_TRUE(atlas_.find(key)->submap.landmark(id));
  }
  std::printf("%zu and %zu of %zu and %zu keyframes are left\n", keyframes(kBack1), keyframes(kBack2),
              whole.find(kBack1)->submap.keyframes.size(), whole.find(kBack2)->submap.keyframes.size());
  for (const auto& [key, placement] : built.placements)
    for (const auto& [id, into] : placement.fused)
      EXPECT_TRUE(atlas_.find(into.submap)->submap.landmark(into.id)) << "fused into what is gone";
  // No frame moves in the map.
  const auto was = whole.map_trajectory(), is = atlas_.map_trajectory();
  ASSERT_EQ(is.size(), size_t{Chain::kImages});
  for (const auto& [image, map_from_cam] : was)
    EXPECT_LT((is.at(image).translation - map_from_cam.translation).norm(), 1e-8);
}

TEST_F(MapCullingTest, TheMapCanBeBuiltAgainOfWhatIsLeft) {
  MapMaker maker;
  build(&maker);
  const size_t left = keyframes(kBack1) + keyframes(kBack2);
  const BuiltMap again = build(&maker);
  EXPECT_LT(chain_->error(atlas_).rmse, 0.04);
  std::printf("%zu keyframes left at first, %zu then\n", left, keyframes(kBack1) + keyframes(kBack2));

  MapMaker fresh;  // it knows nothing, as after a restart
  fresh.find({.submaps = submaps()});
  int accepted = 0;
  for (const Link& link : fresh.graph().links()) accepted += link.accepted() && link.kind == Link::Kind::kSameImages;
  EXPECT_EQ(accepted, 4);
  const BuiltMap anew = fresh.build({.submaps = submaps()});
  EXPECT_EQ(anew.placements.size(), 5u);
  testing::place_map(&atlas_, anew.placements);
  const PathError error = chain_->error(atlas_);
  std::printf("anew: ATE %.1f mm, worst %.1f mm\n", 1000 * error.rmse, 1000 * error.worst);
  EXPECT_LT(error.rmse, 0.04);
  EXPECT_LT(error.worst, 0.1);
}

TEST_F(MapCullingTest, WhatWasRefusedKeepsAllImages) {
  Atlas spoiled;
  for (const auto& [key, owner] : atlas_.submaps())
    put(key == kFront1 ? chain_->spoiled(kFront1) : owner.submap, &spoiled);
  atlas_ = spoiled;
  MapMaker maker;
  const BuiltMap built = build(&maker);
  ASSERT_FALSE(built.placements.contains(kFront1));
  ASSERT_TRUE(built.culled.contains(kBack1));
  const auto at_times_of = [](const Submap& front, const Submap& back) {
    std::set<int64_t> times;
    for (const auto& [id, keyframe] : front.keyframes) times.insert(keyframe.utime_us);
    return std::count_if(back.keyframes.begin(), back.keyframes.end(),
                         [&](const auto& item) { return times.contains(item.second.utime_us); });
  };
  const Submap& front = atlas_.find(kFront1)->submap;
  EXPECT_GT(at_times_of(front, chain_->submap(kBack1)), 4);
  EXPECT_EQ(at_times_of(front, *built.culled.at(kBack1)), at_times_of(front, chain_->submap(kBack1)));
}

}  // namespace
}  // namespace rumi::testing
