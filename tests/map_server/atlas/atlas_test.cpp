// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/atlas/atlas.h"

#include <cmath>
#include <stdexcept>

#include "tests/map_server/place_map.h"
#include "tests/map_server/test_atlas.h"

namespace rumi::map_server {
namespace {

using testing::make_placement;
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

TEST(Atlas, SubmapsAreNamedInOrderOrCounted) {
  EXPECT_EQ(describe(std::set<SubmapKey>{{7, 3}}), "submap 3");
  EXPECT_EQ(describe(std::set<SubmapKey>{{7, 2}, {7, -1}, {7, 1}}), "submaps 1, -1 and 2");
  EXPECT_EQ(describe(std::set<SubmapKey>{{7, 1}, {8, 1}}), "2 submaps");
  std::set<SubmapKey> many;
  for (int id = 1; id <= 12; ++id) many.insert({7, id});
  EXPECT_EQ(describe(many), "12 submaps");
}

TEST(Atlas, AmongEqualsTheEarliestIsTheMap) {
  Atlas atlas;
  update_atlas(&atlas, make_submap({7, 1}, 1, 3, 9'000'000));
  update_atlas(&atlas, make_submap({7, 2}, 2, 3, 1'000'000));
  EXPECT_TRUE(atlas.find({7, 2})->in_map);
  EXPECT_FALSE(atlas.find({7, 1})->in_map);
}

TEST(Atlas, ABackSubmapIsTheMapWhereThereIsNoFrontOne) {
  const auto back_submap = [](int id, uint32_t seed, int steps) {
    Submap submap = make_submap({7, id}, seed, steps);
    submap.kind = SubmapKind::kBack;
    return submap;
  };
  Atlas atlas;
  update_atlas(&atlas, back_submap(-1, 1, 3));
  EXPECT_TRUE(atlas.find({7, -1})->in_map);
  EXPECT_EQ(atlas.map_trajectory().size(), atlas.frames().size());
  update_atlas(&atlas, back_submap(-2, 2, 5));
  EXPECT_TRUE(atlas.find({7, -2})->in_map) << "the largest";
  EXPECT_FALSE(atlas.find({7, -1})->in_map);
  update_atlas(&atlas, make_submap({7, 1}, 3, 2));
  EXPECT_TRUE(atlas.find({7, 1})->in_map) << "until somebody has found out which belong together";
  EXPECT_FALSE(atlas.find({7, -2})->in_map);
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
  update_atlas(&atlas, big.submap());  // the same revision again
  EXPECT_EQ(atlas.revision(), revision);
  big.step();
  update_atlas(&atlas, big.submap());
  EXPECT_GT(atlas.revision(), revision);
}

TEST(Atlas, ARejectedChangeLeavesNoTrace) {
  Atlas atlas;
  EXPECT_EQ(atlas.change_submap({7, 1}, [](Submap*) -> Result<> { return Error{"no"}; }).error_text(), "no");
  EXPECT_EQ(atlas.change_submap({7, 1}, [](Submap*) { return Result<>(); }).error_text(), "");
  EXPECT_TRUE(atlas.submaps().empty());
  EXPECT_EQ(atlas.revision(), 0);
}

TEST(Atlas, PosesMayComeLaterAndStatesMayComeLate) {
  Atlas atlas;
  EXPECT_TRUE(atlas.record_frame({1'000'000}, {.session = 7, .state = TrackingState::kNotInitialized}));
  EXPECT_FALSE(atlas.record_frame({1'000'000}, {.session = 7, .state = TrackingState::kNotInitialized}));
  EXPECT_FALSE(atlas.locate({1'000'000}));
  update_atlas(&atlas, make_submap({7, 1}, 1, 1));
  EXPECT_EQ(atlas.frames().at({1'000'000}).state, TrackingState::kNotInitialized);
  ASSERT_TRUE(atlas.locate({1'000'000}));
  EXPECT_EQ(atlas.locate({1'000'000})->owner->submap.key.id, 1);
  EXPECT_EQ(atlas.frames().at({1'033'333}).state, TrackingState::kUnknown);
  EXPECT_TRUE(atlas.record_frame({1'033'333}, {.session = 7, .state = TrackingState::kTracking, .submap_id = 1}));
  EXPECT_EQ(atlas.frames().at({1'033'333}).state, TrackingState::kTracking);
}

TEST(Atlas, AFrameInSeveralSubmapsIsWhereTheMapIsThenWhereItWasTracked) {
  Atlas atlas;
  update_atlas(&atlas, make_submap({7, -1}, 1, 2));
  update_atlas(&atlas, make_submap({7, 2}, 2, 3));
  update_atlas(&atlas, make_submap({7, 3}, 3, 9));
  atlas.record_frame({1'000'000}, {.session = 7, .state = TrackingState::kTracking, .submap_id = 2});
  EXPECT_EQ(atlas.locate({1'000'000})->owner->submap.key.id, 3);
  Atlas without_big;
  update_atlas(&without_big, make_submap({7, -1}, 1, 2));
  update_atlas(&without_big, make_submap({7, 2}, 2, 2));
  update_atlas(&without_big, make_submap({7, 9}, 3, 9, 800'000'000));
  EXPECT_EQ(without_big.locate({1'000'000})->owner->submap.key.id, 2);  // a front submap comes before a back submap
  update_atlas(&without_big, make_submap({7, -2}, 1, 2));
  without_big.record_frame({1'000'000}, {.session = 7, .state = TrackingState::kTracking, .submap_id = -2});
  EXPECT_EQ(without_big.locate({1'000'000})->owner->submap.key.id, -2);
}

TEST(Atlas, AKeyframeCountsMoreThanAFrameBetweenKeyframes) {
  Submap front = make_submap({7, 1}, 1, 9), back = make_submap({7, -1}, 1, 9);
  back.kind = SubmapKind::kBack;
  const int64_t between_us = std::find_if(front.frames.begin(), front.frames.end(), [&](const auto& f) {
                               return front.keyframe(f.second.reference_keyframe)->utime_us != f.first;
                             })->first;
  Keyframe& keyframe = back.keyframes.begin()->second;
  keyframe.utime_us = between_us;
  back.frames.set({between_us, keyframe.id, SE3(), back.revision});
  Atlas atlas;
  update_atlas(&atlas, front);
  update_atlas(&atlas, back);
  EXPECT_EQ(atlas.locate({between_us})->owner->submap.key.id, 1) << "the back submap is not in the map";
  testing::place_map(&atlas, {{{7, 1}, {}}, {{7, -1}, {}}});
  EXPECT_EQ(atlas.locate({between_us})->owner->submap.key.id, -1);
}

TEST(Atlas, BetweenKeyframesABackSubmapCountsMoreThanWhereTheFrameWasTracked) {
  const Submap front = make_submap({7, 1}, 1, 9);
  Submap back = make_submap({7, -1}, 1, 9);
  back.kind = SubmapKind::kBack;
  const auto is_keyframe = [&front](const auto& f) {
    return front.keyframe(f.second.reference_keyframe)->utime_us == f.first;
  };
  Atlas atlas;
  update_atlas(&atlas, front);
  update_atlas(&atlas, back);
  for (const auto& [utime_us, frame] : front.frames)
    atlas.record_frame({utime_us}, {.session = 7, .state = TrackingState::kTracking, .submap_id = 1});
  const int64_t between_us = std::find_if_not(front.frames.begin(), front.frames.end(), is_keyframe)->first;
  EXPECT_EQ(atlas.locate({between_us})->owner->submap.key.id, 1) << "the back submap is not in the map";
  testing::place_map(&atlas, {{{7, 1}, {}}, {{7, -1}, {}}});
  EXPECT_EQ(atlas.locate({between_us})->owner->submap.key.id, -1);
}

TEST(Atlas, FramesOfTwoStreamsThatHaveTheSameTimesAreKeptApart) {
  Atlas atlas;
  Submap first = make_submap({7, 1}, 1, 3), second = make_submap({8, 1}, 2, 5);
  first.stream = 70;
  second.stream = 80;
  update_atlas(&atlas, first);
  update_atlas(&atlas, second);
  const ImageId in_first{1'000'000, 70}, in_second{1'000'000, 80};
  EXPECT_TRUE(atlas.record_frame(in_first, {.session = 7, .state = TrackingState::kTracking, .submap_id = 1}));
  EXPECT_TRUE(atlas.record_frame(in_second, {.session = 8, .state = TrackingState::kLost}));
  EXPECT_EQ(atlas.frames().size(), 12 + 20);
  EXPECT_EQ(atlas.frames().at(in_first).state, TrackingState::kTracking);
  EXPECT_EQ(atlas.locate(in_first)->owner->submap.key, first.key);
  EXPECT_EQ(atlas.locate(in_second)->owner->submap.key, second.key);
  EXPECT_FALSE(atlas.locate({1'000'000, 90}));
  std::map<SubmapKey, Placement> placements;
  for (const Submap* submap : {&first, &second}) placements[submap->key] = make_placement(*submap, 9);
  testing::place_map(&atlas, placements);
  EXPECT_EQ(atlas.map_trajectory().size(), 12 + 20);
  EXPECT_EQ(atlas.frames_in_map(), 12 + 20);
}

// Submap 1 with 20 frames and submap -1 with 12 frames of the same times are in the map; submap 2 is not.
Atlas placed_atlas() {
  Atlas atlas;
  update_atlas(&atlas, make_submap({7, 1}, 1, 5));
  update_atlas(&atlas, make_submap({7, -1}, 2, 3));
  update_atlas(&atlas, make_submap({7, 2}, 3, 2, 50'000'000));
  std::map<SubmapKey, Placement> placements;
  for (const SubmapKey key : {SubmapKey{7, 1}, SubmapKey{7, -1}})
    placements[key] = make_placement(atlas.find(key)->submap, 9);
  testing::place_map(&atlas, placements);
  return atlas;
}

TEST(Atlas, TheMapIsWhatWasPlaced) {
  Atlas atlas = placed_atlas();
  EXPECT_TRUE(atlas.find({7, 1})->in_map);
  EXPECT_TRUE(atlas.find({7, -1})->in_map);
  EXPECT_FALSE(atlas.find({7, 2})->in_map);
  EXPECT_EQ(atlas.frames_in_map(), 20);
  EXPECT_EQ(atlas.find({7, 1})->placement.revision, atlas.revision());
  const AtlasSubmap& front = *atlas.find({7, 1});
  const Keyframe& keyframe = front.submap.keyframes.begin()->second;
  const SE3 expected = front.placement.map_from_submap.at(keyframe.utime_us).transform_camera(keyframe.cam_from_submap);
  EXPECT_EQ(front.placement.cam_from_map(keyframe).translation, expected.translation);
  EXPECT_EQ(atlas.map_trajectory().size(), 20);
}

TEST(Atlas, OnlyWhatMovedGetsANewPlacementRevision) {
  Atlas atlas = placed_atlas();
  const int64_t before = atlas.revision();
  std::map<SubmapKey, Placement> placements{{{7, 1}, atlas.find({7, 1})->placement},
                                            {{7, -1}, atlas.find({7, -1})->placement}};
  placements[{7, -1}].landmarks.begin()->second.x() += 1e-9;
  testing::place_map(&atlas, placements);
  EXPECT_EQ(atlas.revision(), before + 1);
  EXPECT_EQ(atlas.find({7, 1})->placement.revision, before);
  EXPECT_EQ(atlas.find({7, -1})->placement.revision, before + 1);
}

TEST(Atlas, WhatIsSaidNotToHaveMovedStaysWhereItIs) {
  Atlas atlas = placed_atlas();
  const int64_t before = atlas.revision();
  const Placement front = atlas.find({7, 1})->placement;
  Placement back = atlas.find({7, -1})->placement;
  back.landmarks.begin()->second.x() += 1;
  back.fused[atlas.find({7, -1})->submap.landmarks.begin()->first] = {{7, 1}, 1};
  testing::place_map(&atlas, {{{7, -1}, back}}, {{7, 1}});
  EXPECT_TRUE(atlas.find({7, 1})->in_map);
  testing::expect_same(atlas.find({7, 1})->placement, front);
  EXPECT_EQ(atlas.find({7, -1})->placement.revision, before + 1);
  EXPECT_NE(testing::place_error(&atlas, {{{7, -1}, back}}, {{7, 99}}), "");
  EXPECT_NE(testing::place_error(&atlas, {{{7, -1}, back}}), "") << "fused into what is not in the map";
  EXPECT_EQ(atlas.revision(), before + 1);
}

TEST(Atlas, AnotherSubmapDoesNotTakeThePlaceOfAPlacedMapHoweverLarge) {
  Atlas atlas = placed_atlas();
  const int64_t revision = atlas.revision();
  update_atlas(&atlas, make_submap({7, 3}, 4, 40, 90'000'000));
  EXPECT_FALSE(atlas.find({7, 3})->in_map);
  EXPECT_TRUE(atlas.find({7, 1})->in_map);
  EXPECT_EQ(atlas.revision(), revision);
  testing::place_map(&atlas, {});  // without placements the map is the largest submap
  EXPECT_TRUE(atlas.find({7, 3})->in_map);
  EXPECT_FALSE(atlas.find({7, 1})->in_map);
  EXPECT_EQ(atlas.find({7, 1})->placement.revision, 0);
  EXPECT_TRUE(atlas.find({7, 1})->placement.map_from_submap.empty());
  EXPECT_GT(atlas.revision(), revision);
}

TEST(Atlas, PlacementsAndLinksThatMakeNoSenseChangeNothing) {
  Atlas atlas = placed_atlas();
  const Atlas before = atlas;
  const Placement good = make_placement(atlas.find({7, 2})->submap, 1);
  EXPECT_NE(testing::place_error(&atlas, {{{7, 99}, good}}), "");
  Placement bad = good;
  bad.landmarks[0].y() = std::nan("");
  EXPECT_NE(testing::place_error(&atlas, {{{7, 2}, bad}}), "");
  bad = good;
  bad.map_from_submap.begin()->second.scale = 0;
  EXPECT_NE(testing::place_error(&atlas, {{{7, 2}, bad}}), "");
  bad = good;
  bad.fused[1] = {{7, 1}, 1};  // a submap that is not in this map
  EXPECT_NE(testing::place_error(&atlas, {{{7, 2}, bad}}), "");
  EXPECT_FALSE(atlas.set_links({{.a = {7, 1}, .b = {7, 99}}}));
  EXPECT_FALSE(atlas.set_links({{.a = {7, 1}, .b = {7, 2}, .rmse_px = std::nan("")}}));
  testing::expect_same(before, atlas);
}

TEST(Atlas, InTheMapAPlacedKeyframeIsBelievedBeforeOneThatFollows) {
  Atlas atlas;
  update_atlas(&atlas, make_submap({7, 1}, 1, 3));
  update_atlas(&atlas, make_submap({7, -1}, 2, 3));
  atlas.record_frame({1'000'000}, {.session = 7, .state = TrackingState::kTracking, .submap_id = 1});
  std::map<SubmapKey, Placement> placements;
  for (const SubmapKey key : {SubmapKey{7, 1}, SubmapKey{7, -1}})
    for (const auto& [id, keyframe] : atlas.find(key)->submap.keyframes)
      placements[key].map_from_submap[keyframe.utime_us] = Sim3();
  testing::place_map(&atlas, placements);
  EXPECT_EQ(atlas.locate({1'000'000})->owner->submap.key.id, -1);
  placements[{7, -1}].map_from_submap.erase(placements[{7, -1}].map_from_submap.begin());
  testing::place_map(&atlas, placements);
  EXPECT_EQ(atlas.locate({1'000'000})->owner->submap.key.id, 1);
  EXPECT_EQ(atlas.locate({1'133'332})->owner->submap.key.id, -1);  // its keyframe, the next one, is still placed
}

TEST(Atlas, AFusedLandmarkIsThereOnceAsLongAsTheOtherIs) {
  Atlas atlas;
  Submap back = make_submap({7, -1}, 2, 3);
  update_atlas(&atlas, make_submap({7, 1}, 1, 3));
  update_atlas(&atlas, back);
  const int from = atlas.find({7, 1})->submap.landmarks.begin()->first, into = back.landmarks.begin()->first;
  std::map<SubmapKey, Placement> placements{{{7, 1}, {}}, {{7, -1}, {}}};
  placements[{7, 1}].fused[from] = {{7, -1}, into};
  testing::place_map(&atlas, placements);
  EXPECT_FALSE(atlas.stands_for_itself(*atlas.find({7, 1}), from));
  EXPECT_TRUE(atlas.stands_for_itself(*atlas.find({7, -1}), into));
  EXPECT_TRUE(atlas.stands_for_itself(*atlas.find({7, 1}), from + 1));
  ++back.revision;
  back.remove_landmark(into);
  update_atlas(&atlas, back);
  EXPECT_TRUE(atlas.stands_for_itself(*atlas.find({7, 1}), from));
}

}  // namespace
}  // namespace rumi::map_server
