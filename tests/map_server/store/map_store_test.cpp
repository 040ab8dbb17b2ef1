// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/store/map_store.h"

#include <gmock/gmock.h>
#include <signal.h>
#include <sys/mount.h>
#include <sys/wait.h>
#include <unistd.h>

#include <thread>

#include "map_server/store/map_store_schema.h"
#include "tests/map_server/test_atlas.h"

namespace rumi::map_server {
namespace {

using ::testing::AllOf;
using testing::expect_same;
using ::testing::HasSubstr;
using testing::make_placement;
using testing::make_submap;
using testing::SubmapMaker;
using testing::TemporaryFolder;
using testing::update_atlas;

std::string open_error(const std::string& file) {
  try {
    MapStore store(file);
    store.load();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

Atlas full_atlas() {
  Atlas atlas;
  update_atlas(&atlas, make_submap({7, 1}, 1, 12));
  update_atlas(&atlas, make_submap({7, 2}, 2, 5, 9'000'000));
  Submap of_another_stream = make_submap({8, -1}, 3, 3, 12'000'000);
  of_another_stream.stream = 9;
  update_atlas(&atlas, of_another_stream);
  atlas.record_frame({1'000'000, 9}, {.session = 8, .state = TrackingState::kLost});
  atlas.record_frame({500'000}, {.session = 7, .state = TrackingState::kNotInitialized});
  atlas.record_frame({1'000'000}, {.session = 7, .state = TrackingState::kTracking, .submap_id = 1});
  return atlas;
}

// Submaps 1 and -1 are the map, in pieces; what is known of all pairs.
Atlas merged_atlas() {
  Atlas atlas = full_atlas();
  std::map<SubmapKey, Placement> placements;
  for (const SubmapKey key : {SubmapKey{7, 1}, SubmapKey{8, -1}})
    placements[key] = make_placement(atlas.find(key)->submap, 4);
  for (int id = 0; id < 5; ++id) placements[{7, 1}].fused[100 + id] = {{8, -1}, 7 * id};
  atlas.place_map(placements);
  atlas.set_links({{.a = {7, 1},
                    .b = {8, -1},
                    .kind = Link::Kind::kSameImages,
                    .b_from_a = Sim3(0.3, so3_exp({1, 2, 3}), {4, -0.0, 6}),
                    .keyframes = 12,
                    .keyframe_inliers = 11,
                    .landmarks = 300,
                    .landmark_inliers = 290,
                    .rmse_px = 0.7,
                    .doubt = ""},
                   {.a = {7, 1}, .b = {8, -1}, .kind = Link::Kind::kAppearance, .doubt = "3 of 50 landmarks agree"},
                   {.a = {7, 2}, .b = {8, -1}, .doubt = "no 'image' in common"}});
  return atlas;
}

std::vector<ImageId> all_frames(const Atlas& atlas) {
  std::vector<ImageId> images;
  for (const auto& [image, record] : atlas.frames()) images.push_back(image);
  return images;
}

TEST(MapStore, LoadsWhatWasSavedBitForBit) {
  const TemporaryFolder folder;
  const Atlas atlas = full_atlas();
  {
    MapStore store(folder / "map.db");
    EXPECT_TRUE(store.load().submaps().empty());
    ASSERT_EQ(store.save(atlas, all_frames(atlas)), "");
    EXPECT_EQ(store.stored_revision({7, 1}), 12);
    EXPECT_EQ(store.stored_revision({7, 3}), 0);
  }
  MapStore store(folder / "map.db");
  expect_same(atlas, store.load());
  EXPECT_EQ(store.stored_revision({7, 1}), 12);
}

TEST(MapStore, PlacementsAndLinksComeBackBitForBit) {
  const TemporaryFolder folder;
  Atlas atlas = merged_atlas();
  {
    MapStore store(folder / "map.db");
    ASSERT_EQ(store.save(atlas, all_frames(atlas)), "");
  }
  {
    MapStore store(folder / "map.db");
    expect_same(atlas, store.load());
    // And go on from there: one submap moves, one leaves the map, a link is gone, one is another now.
    atlas.place_map({{{7, 1}, make_placement(atlas.find({7, 1})->submap, 5)}, {{7, 2}, {}}});
    std::vector<Link> links = atlas.links();
    links.pop_back();
    links[0].doubt = "not any more";
    atlas.set_links(links);
    ASSERT_EQ(store.save(atlas, {}), "");
  }
  MapStore store(folder / "map.db");
  expect_same(atlas, store.load());
}

TEST(MapStore, APlacementIsWrittenOnlyWhenItChanged) {
  const TemporaryFolder folder;
  Atlas atlas = merged_atlas();
  MapStore store(folder / "map.db");
  ASSERT_EQ(store.save(atlas, {}), "");
  // Somebody else's mark on every row tells which were written again.
  Database other(folder / "map.db");
  other.execute("UPDATE placed_landmarks SET position = x'00'; UPDATE links SET accepted = 7");
  std::map<SubmapKey, Placement> placements{{{7, 1}, atlas.find({7, 1})->placement},
                                            {{8, -1}, atlas.find({8, -1})->placement}};
  placements[{8, -1}].map_from_submap.begin()->second.scale += 1;
  atlas.place_map(placements);
  update_atlas(&atlas, make_submap({7, 1}, 1, 13));
  ASSERT_EQ(store.save(atlas, {}), "");
  EXPECT_EQ(other.integer("SELECT count(DISTINCT submap) FROM placed_landmarks WHERE position = x'00'"), 1);
  EXPECT_EQ(other.integer("SELECT count(DISTINCT submap) FROM placed_landmarks WHERE position <> x'00'"), 1);
  EXPECT_EQ(other.integer("SELECT count(*) FROM links WHERE accepted = 7"), 3);
  std::vector<Link> links = atlas.links();
  links[1].rmse_px = 2;
  atlas.set_links(links);
  ASSERT_EQ(store.save(atlas, {}), "");
  EXPECT_EQ(other.integer("SELECT count(*) FROM links WHERE revision = " + std::to_string(atlas.revision())), 3);
  EXPECT_EQ(other.integer("SELECT sum(accepted) FROM links"), 1);
}

// Three submaps that lie elsewhere with each seed.
void place_all(Atlas* atlas, uint32_t seed) {
  std::map<SubmapKey, Placement> placements;
  for (const auto& [key, owner] : atlas->submaps()) placements[key] = make_placement(owner.submap, seed);
  atlas->place_map(placements);
  atlas->set_links({{.a = {7, 1}, .b = {7, 2}, .keyframes = static_cast<int>(seed), .doubt = "none"}});
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
  MapStore store(file);
  ASSERT_EQ(store.save(atlas, all_frames(atlas)), "");
  EXPECT_FALSE(store.is_behind());
  const Atlas before = store.load();
  place_all(&atlas, 2);
  ASSERT_EQ(store.save(atlas, {}, kNoTime), "");
  EXPECT_TRUE(store.is_behind());
  expect_same(before, MapStore::copy_in_memory(file).load());
  // Updates are stored meanwhile.
  update_atlas(&atlas, make_submap({7, 1}, 1, 13));
  ASSERT_EQ(store.save(atlas, {}, kNoTime), "");
  EXPECT_EQ(store.stored_revision({7, 1}), 13);
  for (const SubmapKey key : {SubmapKey{7, 1}, SubmapKey{7, 2}, SubmapKey{8, -1}})
    expect_same(before.find(key)->placement, MapStore::copy_in_memory(file).load().find(key)->placement);
  for (int i = 0; i < 20 && store.is_behind(); ++i) ASSERT_EQ(store.save(atlas, {}, kNoTime), "");
  EXPECT_FALSE(store.is_behind());
  EXPECT_EQ(rows_that_do_not_count(file), 0);
  expect_same(atlas, MapStore::copy_in_memory(file).load());
}

TEST(MapStore, WhatADeathLeftHalfWrittenDoesNotCountAndIsRemoved) {
  const TemporaryFolder folder;
  const std::string file = folder / "map.db";
  Atlas atlas = full_atlas();
  place_all(&atlas, 1);
  {
    MapStore store(file);
    ASSERT_EQ(store.save(atlas, all_frames(atlas)), "");
    Atlas doomed = atlas;
    place_all(&doomed, 2);
    ASSERT_EQ(store.save(doomed, {}, std::chrono::milliseconds(0)), "");
  }
  ASSERT_GT(rows_that_do_not_count(file), 0);
  MapStore store(file);
  Atlas next = store.load();
  expect_same(atlas, next);
  std::map<SubmapKey, Placement> fewer;  // under the same revision
  fewer[{7, 1}].map_from_submap[atlas.find({7, 1})->submap.keyframes.begin()->second.utime_us] = Sim3();
  next.place_map(fewer);
  ASSERT_EQ(store.save(next, {}), "");
  EXPECT_EQ(rows_that_do_not_count(file), 0);
  expect_same(next, store.load());
}

// Many small saves with additions, corrections and removals leave the same as one of the whole.
TEST(MapStore, IncrementalSavesAddUp) {
  const TemporaryFolder folder;
  Atlas atlas;
  {
    MapStore store(folder / "map.db");
    SubmapMaker first({7, 1}, 1), second({7, 2}, 2, 50'000'000);
    for (int i = 0; i < 30; ++i) {
      first.step();
      update_atlas(&atlas, first.submap());
      if (i % 3 == 0) second.step(), second.step();
      if (i % 3 == 0) update_atlas(&atlas, second.submap());
      ASSERT_EQ(store.save(atlas, {}), "");
    }
  }
  const Submap& saved = atlas.find({7, 1})->submap;
  ASSERT_NE(saved.removed_keyframes.since(0), std::vector<int>());
  ASSERT_NE(saved.removed_landmarks.since(0), std::vector<int>());
  MapStore store(folder / "map.db");
  Atlas loaded = store.load();
  expect_same(atlas, loaded);
  // And the loaded one goes on.
  SubmapMaker third({7, 3}, 3, 90'000'000);
  third.step();
  update_atlas(&loaded, third.submap());
  ASSERT_EQ(store.save(loaded, {}), "");
}

TEST(MapStore, AnIdMayComeBack) {
  const TemporaryFolder folder;
  Submap submap = make_submap({7, 1}, 1, 3);
  Atlas atlas;
  update_atlas(&atlas, submap);
  MapStore store(folder / "map.db");
  ASSERT_EQ(store.save(atlas, {}), "");
  const Landmark landmark = submap.landmarks.rbegin()->second;
  ++submap.revision;
  submap.remove_landmark(landmark.id);
  update_atlas(&atlas, submap);
  ASSERT_EQ(store.save(atlas, {}), "");
  ++submap.revision;
  submap.landmarks[landmark.id] = {
      .id = landmark.id, .position = {1, 2, 3}, .descriptor = {}, .observations = {}, .revision = submap.revision};
  update_atlas(&atlas, submap);
  ASSERT_EQ(store.save(atlas, {}), "");
  expect_same(atlas, store.load());
}

TEST(MapStore, WhatForgotItsRemovalsIsWrittenAnew) {
  const TemporaryFolder folder;
  Atlas atlas;
  SubmapMaker maker({7, 1}, 1);
  for (int i = 0; i < 5; ++i) maker.step();
  update_atlas(&atlas, maker.submap());
  MapStore store(folder / "map.db");
  ASSERT_EQ(store.save(atlas, {}), "");
  for (int i = 0; i < 10; ++i) maker.step();
  Submap submap = maker.submap();
  const int64_t saved_revision = atlas.find({7, 1})->submap.revision;
  ASSERT_NE(submap.removed_landmarks.since(saved_revision), std::vector<int>());
  submap.removed_landmarks.forget(submap.revision);
  ASSERT_EQ(atlas.change_submap(submap.key, [&submap](Submap* s) { return *s = submap, std::string(); }), "");
  ASSERT_EQ(store.save(atlas, {}), "");
  expect_same(atlas, store.load());
}

TEST(MapStore, KeepsTheMapInMemoryWithoutAFile) {
  MapStore store(":memory:");
  const Atlas atlas = full_atlas();
  ASSERT_EQ(store.save(atlas, all_frames(atlas)), "");
  expect_same(atlas, store.load());
  EXPECT_FALSE(std::filesystem::exists(":memory:.lock"));
}

TEST(MapStore, ACopyInMemoryLeavesTheFileAsItIs) {
  const TemporaryFolder folder;
  const std::string file = folder / "map.db";
  Atlas atlas = full_atlas();
  {
    MapStore store(file);
    ASSERT_EQ(store.save(atlas, all_frames(atlas)), "");
    MapStore beside = MapStore::copy_in_memory(file);
    expect_same(atlas, beside.load());
  }
  const std::string before = testing::read_file(file);
  {
    MapStore copy = MapStore::copy_in_memory(file);
    expect_same(atlas, copy.load());
    update_atlas(&atlas, make_submap({7, 3}, 9, 5, 20'000'000));
    ASSERT_EQ(copy.save(atlas, all_frames(atlas)), "");
    expect_same(atlas, copy.load());
  }
  EXPECT_EQ(testing::read_file(file), before);
  testing::write_file(folder / "none.db", "no database");
  for (const char* name : {"absent.db", "none.db"}) {
    try {
      MapStore::copy_in_memory(folder / name);
      ADD_FAILURE() << name;
    } catch (const std::runtime_error& error) {
      EXPECT_THAT(error.what(), HasSubstr(name));
    }
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "absent.db"));
}

// Nobody else can even read it.
Database lock_for_oneself(const std::string& file) {
  Database holder(file);
  holder.execute("PRAGMA locking_mode = EXCLUSIVE; BEGIN EXCLUSIVE");
  return holder;
}

std::string copy_error(const std::string& file) {
  try {
    MapStore::copy_in_memory(file, std::chrono::milliseconds(5));
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(MapStore, ABusyDatabaseIsSaidToBeBusyAndNotTakenForAnEmptyOne) {
  const TemporaryFolder folder;
  const std::string file = folder / "map.db";
  { ASSERT_EQ(MapStore(file).save(full_atlas(), {}), ""); }
  const Database holder = lock_for_oneself(file);
  EXPECT_THAT(copy_error(file), AllOf(HasSubstr("map.db is busy"), HasSubstr("0.005 s"),
                                      HasSubstr("no map_server has it open"), HasSubstr("try again")));
  const DatabaseLock server(file);
  EXPECT_THAT(copy_error(file), HasSubstr("a map_server, pid " + std::to_string(getpid())));
}

TEST(MapStore, AReaderWaitsForAWriter) {
  const TemporaryFolder folder;
  const std::string file = folder / "map.db";
  const Atlas atlas = full_atlas();
  { ASSERT_EQ(MapStore(file).save(atlas, all_frames(atlas)), ""); }
  Database holder = lock_for_oneself(file);
  const std::jthread writer([&holder] {
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    holder = Database();
  });
  expect_same(atlas, MapStore::copy_in_memory(file).load());
}

TEST(MapStore, CopyIsAWholeMapOfItsOwn) {
  const TemporaryFolder folder;
  const Atlas atlas = full_atlas();
  MapStore store(folder / "map.db");
  ASSERT_EQ(store.save(atlas, all_frames(atlas)), "");
  ASSERT_EQ(store.write_copy(folder / "copy.db"), "");
  ASSERT_EQ(store.write_copy(folder / "copy.db"), "");  // replaces
  const std::string copy = testing::read_file(folder / "copy.db");
  for (const bool in_thread : {false, true}) {
    const DatabaseBytes got = store.begin_copy_bytes(in_thread).get();
    EXPECT_EQ(got.error, "");
    EXPECT_EQ(std::string(got.bytes.begin(), got.bytes.end()), copy);
    EXPECT_EQ(store.begin_copy(folder / "copy.db", in_thread).get(), "");
    EXPECT_EQ(testing::read_file(folder / "copy.db"), copy);
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "copy.db.tmp"));
  MapStore copied(folder / "copy.db");
  expect_same(atlas, copied.load());
  EXPECT_THAT(store.write_copy(folder / "absent/copy.db"), HasSubstr("absent/copy.db"));
}

TEST(MapStore, ACopyIsCalledOffWhenTheProcessEnds) {
  const TemporaryFolder folder;
  Atlas atlas;
  update_atlas(&atlas, make_submap({7, 1}, 1, 40));
  MapStore store(folder / "map.db");
  ASSERT_EQ(store.save(atlas, {}), "");
  store.call_off_copies();
  EXPECT_THAT(store.begin_copy(folder / "copy.db", true).get(), HasSubstr("interrupted"));
  EXPECT_NE(store.begin_copy_bytes(true).get().error, "");
  EXPECT_FALSE(std::filesystem::exists(folder / "copy.db.tmp"));
  EXPECT_EQ(store.save(atlas, {}), "");
}

// A replay must give the same file every time.
TEST(MapStore, TheSameHistoryGivesTheSameBytes) {
  std::vector<uint8_t> copies[2];
  for (std::vector<uint8_t>& copy : copies) {
    MapStore store(":memory:");
    Atlas atlas;
    SubmapMaker maker({7, 1}, 1);
    for (int i = 0; i < 8; ++i) {
      maker.step();
      update_atlas(&atlas, maker.submap());
      ASSERT_EQ(store.save(atlas, all_frames(atlas)), "");
    }
    copy = store.begin_copy_bytes(false).get().bytes;
  }
  EXPECT_GT(copies[0].size(), 10'000);
  EXPECT_EQ(copies[0], copies[1]);
}

TEST(MapStore, SecondServerOnTheSameFileIsRefusedByName) {
  const TemporaryFolder folder;
  {
    MapStore store(folder / "map.db");
    EXPECT_THAT(
        open_error(folder / "map.db"),
        AllOf(HasSubstr("another map_server"), HasSubstr("pid " + std::to_string(getpid())), HasSubstr("map.db.lock")));
  }
  EXPECT_EQ(open_error(folder / "map.db"), "");
  EXPECT_FALSE(std::filesystem::exists(folder / "map.db.lock"));
  testing::write_file(folder / "map.db.lock", "4711");  // of one that was killed
  EXPECT_EQ(open_error(folder / "map.db"), "");
}

TEST(MapStore, BadFilesAreNamedAndLeftAlone) {
  const TemporaryFolder folder;
  EXPECT_THAT(open_error(folder / "absent/map.db"), HasSubstr("absent/map.db.lock"));
  EXPECT_THAT(open_error(""), HasSubstr("map_server.database"));

  testing::write_file(folder / "text.db", std::string(5000, 'x'));
  EXPECT_THAT(open_error(folder / "text.db"), AllOf(HasSubstr("text.db"), HasSubstr("not an SQLite database")));
  EXPECT_EQ(testing::read_file(folder / "text.db"), std::string(5000, 'x'));

  Database(folder / "other.db").execute("CREATE TABLE t (x)");
  EXPECT_THAT(open_error(folder / "other.db"), AllOf(HasSubstr("other.db"), HasSubstr("no map of ours")));

  { MapStore store(folder / "newer.db"); }
  Database(folder / "newer.db").execute("PRAGMA user_version = 99");
  EXPECT_THAT(open_error(folder / "newer.db"),
              AllOf(HasSubstr("newer.db"), HasSubstr("99"), HasSubstr("newer program")));

  testing::write_file(folder / "empty.db", "");
  EXPECT_EQ(open_error(folder / "empty.db"), "");
}

TEST(MapStore, DamageIsFoundAtTheStart) {
  const TemporaryFolder folder;
  const Atlas atlas = full_atlas();
  {
    MapStore store(folder / "map.db");
    ASSERT_EQ(store.save(atlas, {}), "");
  }
  const std::string good = testing::read_file(folder / "map.db");
  testing::write_file(folder / "map.db", good.substr(0, good.size() / 2));
  EXPECT_THAT(open_error(folder / "map.db"), AllOf(HasSubstr("map.db"), HasSubstr("damaged")));
  std::string scrambled = good;
  for (size_t i = 20'000; i < 24'000; ++i) scrambled[i] = static_cast<char>(i * 7);
  testing::write_file(folder / "map.db", scrambled);
  EXPECT_THAT(open_error(folder / "map.db"), HasSubstr("damaged"));
}

constexpr const char* kKeyframeIdsOutOfBounds = R"(
    UPDATE keyframes SET id = id + 20000000;
    UPDATE observations SET keyframe = keyframe + 20000000;
    UPDATE features SET keyframe = keyframe + 20000000;
    UPDATE frame_poses SET reference_keyframe = reference_keyframe + 20000000)";

// NaN in place of the first numbers.
constexpr const char* kLandmarkNowhere =
    "UPDATE landmarks SET position = CAST(x'000000000000F87F' || substr(position, 9) AS BLOB)";
constexpr const char* kKeypointNowhere =
    "UPDATE features SET keypoints = CAST(x'0000C07F' || substr(keypoints, 5) AS BLOB)";
constexpr const char* kNoRotation =
    "UPDATE keyframes SET cam_from_submap = CAST(zeroblob(32) || substr(cam_from_submap, 33) AS BLOB)";

// Pages are sound, but what they say would crash whoever follows it.
TEST(MapStore, ContradictoryContentIsFoundAtTheStart) {
  for (const char* sql : {"UPDATE observations SET pairs = x'FFFFFF7F00000000'",
                          "UPDATE observations SET pairs = x'00'",
                          "UPDATE frame_poses SET reference_keyframe = 4711",
                          "UPDATE landmarks SET id = -2 WHERE id = (SELECT min(id) FROM landmarks)",
                          kKeyframeIdsOutOfBounds,
                          "UPDATE features SET octaves = x''",
                          "UPDATE submaps SET levels = 5",
                          "UPDATE submaps SET levels = 0",
                          "UPDATE submaps SET scale_factor = 1",
                          "UPDATE landmarks SET position = x'00'",
                          "DELETE FROM cameras",
                          kLandmarkNowhere,
                          kKeypointNowhere,
                          kNoRotation,
                          "UPDATE cameras SET width = 1000000000",
                          "UPDATE cameras SET fx = 1e-300",
                          "UPDATE cameras SET model = 7",
                          "UPDATE observations SET pairs = CAST(pairs || pairs AS BLOB)",
                          "UPDATE keyframes SET utime = -1 - utime",
                          "UPDATE submaps SET kind = 300",
                          "UPDATE placed_keyframes SET map_from_submap = x'00'",
                          "UPDATE placed_keyframes SET map_from_submap = zeroblob(64)",
                          "UPDATE placed_landmarks SET position = x'000000000000F87F000000000000F87F000000000000F87F'",
                          "UPDATE OR REPLACE placed_landmarks SET submap = 4711",
                          "UPDATE fused_landmarks SET into_submap = 4711",
                          "UPDATE links SET b = 4711 WHERE doubt = ''",
                          "UPDATE links SET b_from_a = x'00'"}) {
    const TemporaryFolder folder;
    {
      MapStore store(folder / "map.db");
      ASSERT_EQ(store.save(merged_atlas(), {}), "");
    }
    Database(folder / "map.db").execute(sql);
    EXPECT_THAT(open_error(folder / "map.db"), AllOf(HasSubstr("map.db"), HasSubstr("damaged"))) << sql;
  }
}

TEST(MapStore, FullDatabaseRefusesAndCatchesUpLater) {
  const TemporaryFolder folder;
  Atlas atlas;
  MapStore store(folder / "map.db");
  SubmapMaker maker({7, 1}, 1);
  maker.step();
  update_atlas(&atlas, maker.submap());
  ASSERT_EQ(store.save(atlas, {}), "");
  store.limit_bytes(1);
  for (int i = 0; i < 20; ++i) maker.step();
  update_atlas(&atlas, maker.submap());
  EXPECT_THAT(store.save(atlas, {}), AllOf(HasSubstr("map.db"), HasSubstr("no space left")));
  EXPECT_EQ(store.stored_revision({7, 1}), 1);
  store.limit_bytes(int64_t{1} << 40);
  EXPECT_EQ(store.save(atlas, {}), "");
  EXPECT_EQ(store.stored_revision({7, 1}), 21);
  expect_same(atlas, store.load());
}

// The same on a disk that is really full: everything that was accepted is there afterwards.
TEST(MapStore, FullDiskLosesNothingThatWasAccepted) {
  const TemporaryFolder folder;
  const int result = testing::run_on_small_disk(folder.path().string(), 400'000, [&] {
    Atlas atlas, accepted;
    SubmapMaker maker({7, 1}, 1);
    std::string problem;
    {
      MapStore store(folder / "map.db");
      for (int i = 0; i < 500 && problem.empty(); ++i) {
        maker.step();
        update_atlas(&atlas, maker.submap());
        problem = store.save(atlas, {});
        if (problem.empty()) update_atlas(&accepted, maker.submap());
      }
    }
    if (problem.find("map.db") == std::string::npos) return 1;
    if (problem.find("no space left") == std::string::npos) {
      std::fprintf(stderr, "%s\n", problem.c_str());
      return 2;
    }
    MapStore store(folder / "map.db");
    expect_same(accepted, store.load());
    return ::testing::Test::HasFailure() ? 3 : 0;
  });
  if (result < 0) GTEST_SKIP() << "no user namespaces here: cannot mount a small disk";
  EXPECT_EQ(result, 0);
}

TEST(MapStore, ReadOnlyFolderIsNamed) {
  const TemporaryFolder folder;
  const int result = testing::run_on_small_disk(folder.path().string(), 1'000'000, [&] {
    { MapStore store(folder / "map.db"); }
    if (mount("tmpfs", folder.path().c_str(), "tmpfs", MS_REMOUNT | MS_RDONLY, nullptr) != 0) return 1;
    const std::string error = open_error(folder / "map.db");
    std::fprintf(stderr, "%s\n", error.c_str());
    return error.find("map.db.lock") != std::string::npos && error.find("Read-only") != std::string::npos ? 0 : 2;
  });
  if (result < 0) GTEST_SKIP() << "no user namespaces here: cannot mount a small disk";
  EXPECT_EQ(result, 0);
}

// The next update, and with every second one the map is placed anew and linked.
void grow_and_place(SubmapMaker* maker, Atlas* atlas) {
  maker->step();
  update_atlas(atlas, maker->submap());
  const Submap& submap = maker->submap();
  if (submap.revision % 2 != 0) return;
  Placement placement = make_placement(submap, static_cast<uint32_t>(submap.revision));
  placement.fused[submap.landmarks.begin()->first] = {submap.key, submap.landmarks.rbegin()->first};
  atlas->place_map({{submap.key, placement}});
  atlas->set_links(
      {{.a = submap.key, .b = submap.key, .keyframes = static_cast<int>(submap.revision), .doubt = "self"}});
}

// A child saves one update after the other and says so through a pipe; it is killed in the middle.
void save_until_killed(const std::string& file, int pipe_end) {
  MapStore store(file);
  Atlas atlas = store.load();
  SubmapMaker maker({7, 1}, 1);
  for (int64_t revision = 1;; ++revision) {
    grow_and_place(&maker, &atlas);
    if (!store.save(atlas, {}).empty()) _exit(1);
    if (write(pipe_end, &revision, sizeof(revision)) != sizeof(revision)) _exit(2);
  }
}

TEST(MapStore, KillLosesNothingThatWasAccepted) {
  for (int round = 0; round < 4; ++round) {
    const TemporaryFolder folder;
    int ends[2];
    ASSERT_EQ(pipe(ends), 0);
    const pid_t child = fork();
    if (child == 0) {
      close(ends[0]);
      save_until_killed(folder / "map.db", ends[1]);
    }
    close(ends[1]);
    int64_t accepted = 0, revision = 0;
    // Some saves in, then at an arbitrary moment of the next ones.
    while (accepted < 3 + 4 * round && read(ends[0], &revision, sizeof(revision)) == sizeof(revision))
      accepted = revision;
    usleep(1500 * round);
    ASSERT_EQ(kill(child, SIGKILL), 0);
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status)) << WEXITSTATUS(status);
    while (read(ends[0], &revision, sizeof(revision)) == sizeof(revision)) accepted = revision;
    close(ends[0]);

    MapStore store(folder / "map.db");
    const Atlas loaded = store.load();
    const int64_t stored = store.stored_revision({7, 1});
    EXPECT_GE(stored, accepted);
    EXPECT_LE(stored, accepted + 1);  // stored, but killed before it could say so
    // Replay what the child did up to there.
    Atlas expected;
    SubmapMaker maker({7, 1}, 1);
    for (int64_t i = 0; i < stored; ++i) grow_and_place(&maker, &expected);
    expect_same(expected, loaded);
  }
}

}  // namespace
}  // namespace rumi::map_server
