// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/atlas.h"

#include "test_atlas.h"

namespace rumi {
namespace {

using testing::make_submap;
using testing::SubmapMaker;
using testing::update_atlas;

TEST(Atlas, TheSubmapWithMostFramesIsTheMap) {
  Atlas atlas;
  update_atlas(&atlas, make_submap({7, 1}, 1, 3));
  EXPECT_TRUE(atlas.find({7, 1})->in_map);
  update_atlas(&atlas, make_submap({7, 2}, 2, 4, 9'000'000));
  EXPECT_FALSE(atlas.find({7, 1})->in_map);
  EXPECT_TRUE(atlas.find({7, 2})->in_map);
  EXPECT_EQ(atlas.frames_in_map(), 16);
  EXPECT_EQ(atlas.map_trajectory().size(), 16);
  EXPECT_EQ(atlas.frames().size(), 12 + 16);
}

TEST(Atlas, AmongEqualsTheEarliestIsTheMap) {
  Atlas atlas;
  update_atlas(&atlas, make_submap({7, 1}, 1, 3, 9'000'000));
  update_atlas(&atlas, make_submap({7, 2}, 2, 3, 1'000'000));
  EXPECT_TRUE(atlas.find({7, 2})->in_map);
  EXPECT_FALSE(atlas.find({7, 1})->in_map);
}

TEST(Atlas, RevisionRisesWithTheMapOnly) {
  Atlas atlas;
  SubmapMaker big({7, 1}, 1), small({7, 2}, 2, 90'000'000);
  for (int i = 0; i < 5; ++i) big.step();
  update_atlas(&atlas, big.submap());
  const int64_t revision = atlas.revision();
  EXPECT_GT(revision, 0);
  small.step();
  update_atlas(&atlas, small.submap());
  EXPECT_EQ(atlas.revision(), revision);
  update_atlas(&atlas, big.submap());  // nothing new
  EXPECT_EQ(atlas.revision(), revision);
  big.step();
  update_atlas(&atlas, big.submap());
  EXPECT_GT(atlas.revision(), revision);
}

TEST(Atlas, ARejectedChangeLeavesNoTrace) {
  Atlas atlas;
  EXPECT_EQ(atlas.change_submap({7, 1}, [](Submap*) { return std::string("no"); }), "no");
  EXPECT_EQ(atlas.change_submap({7, 1}, [](Submap*) { return std::string(); }), "");
  EXPECT_TRUE(atlas.submaps().empty());
  EXPECT_EQ(atlas.revision(), 0);
}

TEST(Atlas, PosesMayComeLaterAndStatesMayComeLate) {
  Atlas atlas;
  EXPECT_TRUE(atlas.record_frame(1'000'000, {.session = 7, .state = FrameState::kNotInitialized}));
  EXPECT_FALSE(atlas.record_frame(1'000'000, {.session = 7, .state = FrameState::kNotInitialized}));
  EXPECT_FALSE(atlas.locate(1'000'000));
  update_atlas(&atlas, make_submap({7, 1}, 1, 1));
  EXPECT_EQ(atlas.frames().at(1'000'000).state, FrameState::kNotInitialized);
  ASSERT_TRUE(atlas.locate(1'000'000));
  EXPECT_EQ(atlas.locate(1'000'000)->owner->submap.key.id, 1);
  EXPECT_EQ(atlas.frames().at(1'033'333).state, FrameState::kUnknown);
  EXPECT_TRUE(atlas.record_frame(1'033'333, {.session = 7, .state = FrameState::kTracking, .submap_id = 1}));
  EXPECT_EQ(atlas.frames().at(1'033'333).state, FrameState::kTracking);
}

TEST(Atlas, AFrameInSeveralSubmapsIsWhereTheMapIsThenWhereItWasTracked) {
  Atlas atlas;
  update_atlas(&atlas, make_submap({7, -1}, 1, 2));
  update_atlas(&atlas, make_submap({7, 2}, 2, 3));
  update_atlas(&atlas, make_submap({7, 3}, 3, 9));
  atlas.record_frame(1'000'000, {.session = 7, .state = FrameState::kTracking, .submap_id = 2});
  EXPECT_EQ(atlas.locate(1'000'000)->owner->submap.key.id, 3);
  Atlas without_big;
  update_atlas(&without_big, make_submap({7, -1}, 1, 2));
  update_atlas(&without_big, make_submap({7, 2}, 2, 2));
  update_atlas(&without_big, make_submap({7, 9}, 3, 9, 800'000'000));
  EXPECT_EQ(without_big.locate(1'000'000)->owner->submap.key.id, 2);  // front before back
  update_atlas(&without_big, make_submap({7, -2}, 1, 2));
  without_big.record_frame(1'000'000, {.session = 7, .state = FrameState::kTracking, .submap_id = -2});
  EXPECT_EQ(without_big.locate(1'000'000)->owner->submap.key.id, -2);
}

}  // namespace
}  // namespace rumi
