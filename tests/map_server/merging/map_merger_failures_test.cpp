// SPDX-License-Identifier: BSD-3-Clause
// Builds that throw.
#include <gtest/gtest.h>

#include <set>
#include <utility>

#include "tests/map_server/merging/map_merger_fixture.h"

namespace rumi::testing {
namespace {

using BrokenBuildTest = MapMergerTest;

// Formerly, a build that threw ended the process.
TEST_F(BrokenBuildTest, ABuildThatThrowsIsRefusedAndTheNextGoesWithout) {
  for (const bool thread : {false, true}) {
    atlas_ = {};
    options_.thread = thread;
    MapMerger merger(options_);
    for (const SubmapKey key : {Chain::kFront1, Chain::kBack1, Chain::kFront2}) put(key);
    tick_until_idle(&merger, 0);
    const std::set<SubmapKey> three = atlas_.in_map();
    ASSERT_EQ(three.size(), 3u);
    EXPECT_FALSE(merger.in_doubt());

    testing::put(broken(Chain::kBack2), &atlas_);
    tick_until_idle(&merger, 100);
    EXPECT_EQ(merger.refused().count(), 1);
    EXPECT_NE(merger.refused().text(), "");
    EXPECT_EQ(merger.left_out(), std::set<SubmapKey>{Chain::kBack2});
    EXPECT_TRUE(merger.in_doubt());
    EXPECT_EQ(atlas_.in_map(), three);

    put(Chain::kFront3);
    tick_until_idle(&merger, 200);
    EXPECT_EQ(merger.refused().count(), 1) << "it is not tried again as it is";
    testing::put(good(Chain::kBack2, 2), &atlas_);
    tick_until_idle(&merger, 300);
    EXPECT_FALSE(merger.in_doubt());
    EXPECT_EQ(atlas_.in_map().size(), 5u);
    EXPECT_LT(chain_->error(atlas_).rmse, 0.04);
  }
}

TEST_F(BrokenBuildTest, WhereAllIsNewTheOneToBlameIsFound) {
  MapMerger merger(options_);
  for (const SubmapKey key : {Chain::kFront1, Chain::kBack1, Chain::kFront2, Chain::kFront3}) put(key);
  testing::put(broken(Chain::kBack2), &atlas_);
  tick_until_idle(&merger, 0);
  EXPECT_EQ(merger.left_out(), std::set<SubmapKey>{Chain::kBack2});
  EXPECT_EQ(merger.refused().count(), 1);
  EXPECT_EQ(atlas_.in_map(), (std::set<SubmapKey>{Chain::kFront1, Chain::kBack1, Chain::kFront2}));
  EXPECT_LT(chain_->error(atlas_).rmse, 0.04);
}

// As at a start from a database: submaps of the map stay in their place, whichever submap is to blame and whatever is
// tried meanwhile.
TEST_F(BrokenBuildTest, WhatIsInDoubtStaysInTheMapWhereItLay) {
  {
    MapMerger merger(options_);
    for (const SubmapKey key : {Chain::kFront1, Chain::kBack1, Chain::kFront2, Chain::kBack2, Chain::kFront3}) put(key);
    tick_until_idle(&merger, 0);
    ASSERT_EQ(atlas_.in_map().size(), 5u);
  }
  const Placement before = atlas_.find(Chain::kBack2)->placement;
  testing::put(broken(Chain::kBack2, 1 + atlas_.find(Chain::kBack2)->submap.revision), &atlas_);
  MapMerger merger(options_);
  merger.hurry();
  for (int i = 0; i < 100 && !merger.idle(atlas_); ++i) {
    tick(&merger, i);
    ASSERT_EQ(atlas_.in_map().size(), 5u);
  }
  EXPECT_EQ(merger.left_out(), std::set<SubmapKey>{Chain::kBack2});
  EXPECT_TRUE(same_place(before, atlas_.find(Chain::kBack2)->placement));
  EXPECT_LT(chain_->error(atlas_).rmse, 0.05);
}

// The next build begins with the links and the map known before.
TEST_F(BrokenBuildTest, ABuildThatThrowsForgetsNothing) {
  MapMerger merger(options_);
  for (const SubmapKey key : {Chain::kFront1, Chain::kBack1, Chain::kFront2}) put(key);
  tick_until_idle(&merger, 0);
  testing::put(broken(Chain::kBack2), &atlas_);
  EXPECT_FALSE(tick(&merger, 100));
  ASSERT_EQ(merger.refused().count(), 1);
  change(Chain::kFront2);
  const auto next = tick(&merger, 102);
  ASSERT_TRUE(next);
  EXPECT_EQ(next->scope, BuildScope::kWeld);
  EXPECT_EQ(next->report.members, 3);
  EXPECT_TRUE(next->map.placements().empty()) << "the map is what it was: nothing is to be welded anew";
}

}  // namespace
}  // namespace rumi::testing
