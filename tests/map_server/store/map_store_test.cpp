// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/store/map_store.h"

#include <gmock/gmock.h>

#include "tests/map_server/place_map.h"
#include "tests/map_server/store/stored_atlas.h"

namespace rumi::map_server {
namespace {

using testing::all_frames;
using testing::expect_same;
using testing::full_atlas;
using testing::make_placement;
using testing::make_submap;
using testing::merged_atlas;
using testing::SubmapMaker;
using testing::TemporaryFolder;
using testing::update_atlas;

TEST(MapStore, LoadsWhatWasSavedBitForBit) {
  const TemporaryFolder folder;
  const Atlas atlas = full_atlas();
  {
    MapStore store = MapStore::open(folder / "map.db").value();
    EXPECT_TRUE(store.load().value().submaps().empty());
    ASSERT_EQ(store.save(atlas, all_frames(atlas)).error_text(), "");
    EXPECT_EQ(store.stored_revision({7, 1}), 12);
    EXPECT_EQ(store.stored_revision({7, 3}), 0);
  }
  MapStore store = MapStore::open(folder / "map.db").value();
  expect_same(atlas, store.load().value());
  EXPECT_EQ(store.stored_revision({7, 1}), 12);
}

TEST(MapStore, PlacementsAndLinksComeBackBitForBit) {
  const TemporaryFolder folder;
  Atlas atlas = merged_atlas();
  {
    MapStore store = MapStore::open(folder / "map.db").value();
    ASSERT_EQ(store.save(atlas, all_frames(atlas)).error_text(), "");
  }
  {
    MapStore store = MapStore::open(folder / "map.db").value();
    expect_same(atlas, store.load().value());
    // The loaded map goes on: one submap moves, one leaves the map, one link goes, and one changes.
    testing::place_map(&atlas, {{{7, 1}, make_placement(atlas.find({7, 1})->submap, 5)}, {{7, 2}, {}}});
    std::vector<Link> links = atlas.links();
    links.pop_back();
    links[0].doubt = "not any more";
    EXPECT_TRUE(atlas.set_links(links));
    ASSERT_EQ(store.save(atlas, {}).error_text(), "");
  }
  MapStore store = MapStore::open(folder / "map.db").value();
  expect_same(atlas, store.load().value());
}

TEST(MapStore, APlacementIsWrittenOnlyWhenItChanged) {
  const TemporaryFolder folder;
  Atlas atlas = merged_atlas();
  MapStore store = MapStore::open(folder / "map.db").value();
  ASSERT_EQ(store.save(atlas, {}).error_text(), "");
  // Another connection marks all rows, so that one can tell which are written again.
  Database other(folder / "map.db");
  other.execute("UPDATE placed_landmarks SET position = x'00'; UPDATE links SET accepted = 7");
  std::map<SubmapKey, Placement> placements{{{7, 1}, atlas.find({7, 1})->placement},
                                            {{8, -1}, atlas.find({8, -1})->placement}};
  placements[{8, -1}].map_from_submap.begin()->second.scale += 1;
  testing::place_map(&atlas, placements);
  update_atlas(&atlas, make_submap({7, 1}, 1, 13));
  ASSERT_EQ(store.save(atlas, {}).error_text(), "");
  EXPECT_EQ(other.integer("SELECT count(DISTINCT submap) FROM placed_landmarks WHERE position = x'00'"), 1);
  EXPECT_EQ(other.integer("SELECT count(DISTINCT submap) FROM placed_landmarks WHERE position <> x'00'"), 1);
  EXPECT_EQ(other.integer("SELECT count(*) FROM links WHERE accepted = 7"), 3);
  std::vector<Link> links = atlas.links();
  links[1].rmse_px = 2;
  EXPECT_TRUE(atlas.set_links(links));
  ASSERT_EQ(store.save(atlas, {}).error_text(), "");
  EXPECT_EQ(other.integer("SELECT count(*) FROM links WHERE revision = " + std::to_string(atlas.revision())), 3);
  EXPECT_EQ(other.integer("SELECT sum(accepted) FROM links"), 1);
}

// Places all submaps; another seed places them elsewhere.
void place_all(Atlas* atlas, uint32_t seed) {
  std::map<SubmapKey, Placement> placements;
  for (const auto& [key, owner] : atlas->submaps()) placements[key] = make_placement(owner.submap, seed);
  testing::place_map(atlas, placements);
  EXPECT_TRUE(atlas->set_links({{.a = {7, 1}, .b = {7, 2}, .keyframes = static_cast<int>(seed), .doubt = "none"}}));
}

int64_t rows_that_do_not_count(const std::string& file) {
  int64_t rows = 0;
  for (const std::string table : {"placed_keyframes", "placed_landmarks"})
    rows += Database(file).integer("SELECT count(*) FROM " + table +
                                   " p JOIN submaps s ON s.submap = p.submap WHERE p.revision <> s.placement_revision");
  return rows;
}

TEST(MapStore, WhereSubmapsLieIsWrittenInSlicesAndCountsWhenAllIsThere) {
  constexpr std::chrono::milliseconds kNoTime{0};
  const TemporaryFolder folder;
  const std::string file = folder / "map.db";
  Atlas atlas = full_atlas();
  place_all(&atlas, 1);
  MapStore store = MapStore::open(file).value();
  ASSERT_EQ(store.save(atlas, all_frames(atlas)).error_text(), "");
  EXPECT_FALSE(store.is_behind());
  const Atlas before = store.load().value();
  place_all(&atlas, 2);
  ASSERT_EQ(store.save(atlas, {}, kNoTime).error_text(), "");
  EXPECT_TRUE(store.is_behind());
  expect_same(before, load_atlas(file).value());
  // Meanwhile updates are stored.
  update_atlas(&atlas, make_submap({7, 1}, 1, 13));
  ASSERT_EQ(store.save(atlas, {}, kNoTime).error_text(), "");
  EXPECT_EQ(store.stored_revision({7, 1}), 13);
  for (const SubmapKey key : {SubmapKey{7, 1}, SubmapKey{7, 2}, SubmapKey{8, -1}})
    expect_same(before.find(key)->placement, load_atlas(file).value().find(key)->placement);
  for (int i = 0; i < 20 && store.is_behind(); ++i) ASSERT_EQ(store.save(atlas, {}, kNoTime).error_text(), "");
  EXPECT_FALSE(store.is_behind());
  EXPECT_EQ(rows_that_do_not_count(file), 0);
  expect_same(atlas, load_atlas(file).value());
}

TEST(MapStore, WhatADeathLeftHalfWrittenDoesNotCountAndIsRemoved) {
  const TemporaryFolder folder;
  const std::string file = folder / "map.db";
  Atlas atlas = full_atlas();
  place_all(&atlas, 1);
  {
    MapStore store = MapStore::open(file).value();
    ASSERT_EQ(store.save(atlas, all_frames(atlas)).error_text(), "");
    Atlas doomed = atlas;
    place_all(&doomed, 2);
    ASSERT_EQ(store.save(doomed, {}, std::chrono::milliseconds(0)).error_text(), "");
  }
  ASSERT_GT(rows_that_do_not_count(file), 0);
  MapStore store = MapStore::open(file).value();
  Atlas next = store.load().value();
  expect_same(atlas, next);
  std::map<SubmapKey, Placement> fewer;  // its placement has the same revision as the stored one
  fewer[{7, 1}].map_from_submap[atlas.find({7, 1})->submap.keyframes.begin()->second.utime_us] = Sim3();
  testing::place_map(&next, fewer);
  ASSERT_EQ(store.save(next, {}).error_text(), "");
  EXPECT_EQ(rows_that_do_not_count(file), 0);
  expect_same(next, store.load().value());
}

// Many small saves of additions, corrections and removals must give the same as one save of the whole.
TEST(MapStore, IncrementalSavesAddUp) {
  const TemporaryFolder folder;
  Atlas atlas;
  {
    MapStore store = MapStore::open(folder / "map.db").value();
    SubmapMaker first({7, 1}, 1), second({7, 2}, 2, 50'000'000);
    for (int i = 0; i < 30; ++i) {
      first.step();
      update_atlas(&atlas, first.submap());
      if (i % 3 == 0) second.step(), second.step();
      if (i % 3 == 0) update_atlas(&atlas, second.submap());
      ASSERT_EQ(store.save(atlas, {}).error_text(), "");
    }
  }
  const Submap& saved = atlas.find({7, 1})->submap;
  ASSERT_NE(saved.removed_keyframes.since(0), std::vector<int>());
  ASSERT_NE(saved.removed_landmarks.since(0), std::vector<int>());
  MapStore store = MapStore::open(folder / "map.db").value();
  Atlas loaded = store.load().value();
  expect_same(atlas, loaded);
  // The loaded atlas can grow.
  SubmapMaker third({7, 3}, 3, 90'000'000);
  third.step();
  update_atlas(&loaded, third.submap());
  ASSERT_EQ(store.save(loaded, {}).error_text(), "");
}

TEST(MapStore, AnIdMayComeBack) {
  const TemporaryFolder folder;
  Submap submap = make_submap({7, 1}, 1, 3);
  Atlas atlas;
  update_atlas(&atlas, submap);
  MapStore store = MapStore::open(folder / "map.db").value();
  ASSERT_EQ(store.save(atlas, {}).error_text(), "");
  const Landmark landmark = submap.landmarks.rbegin()->second;
  ++submap.revision;
  submap.remove_landmark(landmark.id);
  update_atlas(&atlas, submap);
  ASSERT_EQ(store.save(atlas, {}).error_text(), "");
  ++submap.revision;
  submap.landmarks[landmark.id] = {
      .id = landmark.id, .position = {1, 2, 3}, .descriptor = {}, .observations = {}, .revision = submap.revision};
  update_atlas(&atlas, submap);
  ASSERT_EQ(store.save(atlas, {}).error_text(), "");
  expect_same(atlas, store.load().value());
}

TEST(MapStore, WhatForgotItsRemovalsIsWrittenAnew) {
  const TemporaryFolder folder;
  Atlas atlas;
  SubmapMaker maker({7, 1}, 1);
  for (int i = 0; i < 5; ++i) maker.step();
  update_atlas(&atlas, maker.submap());
  MapStore store = MapStore::open(folder / "map.db").value();
  ASSERT_EQ(store.save(atlas, {}).error_text(), "");
  for (int i = 0; i < 10; ++i) maker.step();
  Submap submap = maker.submap();
  const int64_t saved_revision = atlas.find({7, 1})->submap.revision;
  ASSERT_NE(submap.removed_landmarks.since(saved_revision), std::vector<int>());
  submap.removed_landmarks.forget(submap.revision);
  ASSERT_EQ(atlas.change_submap(submap.key, [&submap](Submap* s) { return *s = submap, Result<>(); }).error_text(), "");
  ASSERT_EQ(store.save(atlas, {}).error_text(), "");
  expect_same(atlas, store.load().value());
}

// Every replay must give the same file.
TEST(MapStore, TheSameHistoryGivesTheSameBytes) {
  std::vector<uint8_t> copies[2];
  for (std::vector<uint8_t>& copy : copies) {
    MapStore store = MapStore::open(":memory:").value();
    Atlas atlas;
    SubmapMaker maker({7, 1}, 1);
    for (int i = 0; i < 8; ++i) {
      maker.step();
      update_atlas(&atlas, maker.submap());
      ASSERT_EQ(store.save(atlas, all_frames(atlas)).error_text(), "");
    }
    copy = store.begin_copy_bytes(false).get().value().bytes;
  }
  EXPECT_GT(copies[0].size(), 10'000);
  EXPECT_EQ(copies[0], copies[1]);
}

}  // namespace
}  // namespace rumi::map_server
