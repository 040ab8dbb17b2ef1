// SPDX-License-Identifier: BSD-3-Clause
// Copies of a database that another process may have open.
#include <gmock/gmock.h>
#include <unistd.h>

#include <thread>

#include "tests/map_server/store/stored_atlas.h"

namespace rumi::map_server {
namespace {

using testing::all_frames;
using ::testing::AllOf;
using testing::expect_same;
using testing::full_atlas;
using ::testing::HasSubstr;
using testing::make_submap;
using testing::open_error;
using testing::TemporaryFolder;
using testing::update_atlas;

TEST(MapStore, KeepsTheMapInMemoryWithoutAFile) {
  MapStore store = MapStore::open(":memory:").value();
  const Atlas atlas = full_atlas();
  ASSERT_EQ(store.save(atlas, all_frames(atlas)).error_text(), "");
  expect_same(atlas, store.load().value());
  EXPECT_FALSE(std::filesystem::exists(":memory:.lock"));
}

TEST(MapStore, ACopyInMemoryLeavesTheFileAsItIs) {
  const TemporaryFolder folder;
  const std::string file = folder / "map.db";
  Atlas atlas = full_atlas();
  {
    MapStore store = MapStore::open(file).value();
    ASSERT_EQ(store.save(atlas, all_frames(atlas)).error_text(), "");
    MapStore beside = MapStore::copy_in_memory(file).value();
    expect_same(atlas, beside.load().value());
  }
  const std::string before = testing::read_file(file);
  {
    MapStore copy = MapStore::copy_in_memory(file).value();
    expect_same(atlas, copy.load().value());
    update_atlas(&atlas, make_submap({7, 3}, 9, 5, 20'000'000));
    ASSERT_EQ(copy.save(atlas, all_frames(atlas)).error_text(), "");
    expect_same(atlas, copy.load().value());
  }
  EXPECT_EQ(testing::read_file(file), before);
  testing::write_file(folder / "none.db", "no database");
  for (const char* name : {"absent.db", "none.db"})
    EXPECT_THAT(MapStore::copy_in_memory(folder / name).error_text(), HasSubstr(name));
  EXPECT_FALSE(std::filesystem::exists(folder / "absent.db"));
}

// Locks the database so that no other connection can even read it.
Database lock_for_oneself(const std::string& file) {
  Database holder(file);
  holder.execute("PRAGMA locking_mode = EXCLUSIVE; BEGIN EXCLUSIVE");
  return holder;
}

std::string copy_error(const std::string& file) {
  return MapStore::copy_in_memory(file, std::chrono::milliseconds(5)).error_text();
}

TEST(MapStore, ABusyDatabaseIsSaidToBeBusyAndNotTakenForAnEmptyOne) {
  const TemporaryFolder folder;
  const std::string file = folder / "map.db";
  { ASSERT_EQ(MapStore::open(file).value().save(full_atlas(), {}).error_text(), ""); }
  const Database holder = lock_for_oneself(file);
  EXPECT_THAT(copy_error(file), AllOf(HasSubstr("map.db is busy"), HasSubstr("0.005 s"),
                                      HasSubstr("no map_server has it open"), HasSubstr("try again")));
  const DatabaseLock server = DatabaseLock::take(file).value();
  EXPECT_THAT(copy_error(file), HasSubstr("a map_server, pid " + std::to_string(getpid())));
}

TEST(MapStore, AReaderWaitsForAWriter) {
  const TemporaryFolder folder;
  const std::string file = folder / "map.db";
  const Atlas atlas = full_atlas();
  { ASSERT_EQ(MapStore::open(file).value().save(atlas, all_frames(atlas)).error_text(), ""); }
  Database holder = lock_for_oneself(file);
  const std::jthread writer([&holder] {
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    holder = Database();
  });
  expect_same(atlas, load_atlas(file).value());
}

TEST(MapStore, CopyIsAWholeMapOfItsOwn) {
  const TemporaryFolder folder;
  const Atlas atlas = full_atlas();
  MapStore store = MapStore::open(folder / "map.db").value();
  ASSERT_EQ(store.save(atlas, all_frames(atlas)).error_text(), "");
  ASSERT_EQ(store.write_copy(folder / "copy.db").error_text(), "");
  ASSERT_EQ(store.write_copy(folder / "copy.db").error_text(), "");  // replaces the first copy
  const std::string copy = testing::read_file(folder / "copy.db");
  for (const bool in_thread : {false, true}) {
    const DatabaseBytes got = store.begin_copy_bytes(in_thread).get().value();
    EXPECT_EQ(std::string(got.bytes.begin(), got.bytes.end()), copy);
    EXPECT_EQ(store.begin_copy(folder / "copy.db", in_thread).get().error_text(), "");
    EXPECT_EQ(testing::read_file(folder / "copy.db"), copy);
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "copy.db.tmp"));
  MapStore copied = MapStore::open(folder / "copy.db").value();
  expect_same(atlas, copied.load().value());
  EXPECT_THAT(store.write_copy(folder / "absent/copy.db").error_text(), HasSubstr("absent/copy.db"));
}

TEST(MapStore, ACopyIsCalledOffWhenTheProcessEnds) {
  const TemporaryFolder folder;
  Atlas atlas;
  update_atlas(&atlas, make_submap({7, 1}, 1, 40));
  MapStore store = MapStore::open(folder / "map.db").value();
  ASSERT_EQ(store.save(atlas, {}).error_text(), "");
  store.call_off_copies();
  EXPECT_THAT(store.begin_copy(folder / "copy.db", true).get().error_text(), HasSubstr("interrupted"));
  EXPECT_NE(store.begin_copy_bytes(true).get().error_text(), "");
  EXPECT_FALSE(std::filesystem::exists(folder / "copy.db.tmp"));
  EXPECT_EQ(store.save(atlas, {}).error_text(), "");
}

TEST(MapStore, SecondServerOnTheSameFileIsRefusedByName) {
  const TemporaryFolder folder;
  {
    MapStore store = MapStore::open(folder / "map.db").value();
    EXPECT_THAT(
        open_error(folder / "map.db"),
        AllOf(HasSubstr("another map_server"), HasSubstr("pid " + std::to_string(getpid())), HasSubstr("map.db.lock")));
  }
  EXPECT_EQ(open_error(folder / "map.db"), "");
  EXPECT_FALSE(std::filesystem::exists(folder / "map.db.lock"));
  testing::write_file(folder / "map.db.lock", "4711");  // left by a process that was killed
  EXPECT_EQ(open_error(folder / "map.db"), "");
}

}  // namespace
}  // namespace rumi::map_server
