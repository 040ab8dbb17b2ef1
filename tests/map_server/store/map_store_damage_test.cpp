// SPDX-License-Identifier: BSD-3-Clause
// Files that are no map or a damaged one, full disks, a killed process: nothing accepted is lost.
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/mount.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>

#include "tests/map_server/place_map.h"
#include "tests/map_server/store/stored_atlas.h"
#include "tests/support/ordinary_user.h"

namespace rumi::map_server {
namespace {

using ::testing::AllOf;
using testing::expect_same;
using testing::full_atlas;
using ::testing::HasSubstr;
using testing::make_placement;
using testing::merged_atlas;
using testing::open_error;
using testing::SubmapMaker;
using testing::TemporaryFolder;
using testing::update_atlas;

TEST(MapStore, BadFilesAreNamedAndLeftAlone) {
  const TemporaryFolder folder;
  EXPECT_THAT(open_error(folder / "absent/map.db"),
              AllOf(HasSubstr("cannot create map.db.lock in the folder " + (folder / "absent")),
                    HasSubstr("make that folder, or name another file")));
  EXPECT_THAT(open_error(""), HasSubstr("map_server.database"));

  testing::write_file(folder / "text.db", std::string(5000, 'x'));
  EXPECT_THAT(open_error(folder / "text.db"), AllOf(HasSubstr("text.db"), HasSubstr("not an SQLite database")));
  EXPECT_EQ(testing::read_file(folder / "text.db"), std::string(5000, 'x'));

  Database(folder / "other.db").execute("CREATE TABLE t (x)");
  EXPECT_THAT(open_error(folder / "other.db"), AllOf(HasSubstr("other.db"), HasSubstr("no map of ours")));

  { MapStore store = MapStore::open(folder / "newer.db").value(); }
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
    MapStore store = MapStore::open(folder / "map.db").value();
    ASSERT_EQ(store.save(atlas, {}).error_text(), "");
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

// These put NaN in place of the first numbers, and zeros in place of a rotation.
constexpr const char* kLandmarkNowhere =
    "UPDATE landmarks SET position = CAST(x'000000000000F87F' || substr(position, 9) AS BLOB)";
constexpr const char* kKeypointNowhere =
    "UPDATE features SET keypoints = CAST(x'0000C07F' || substr(keypoints, 5) AS BLOB)";
constexpr const char* kNoRotation =
    "UPDATE keyframes SET cam_from_submap = CAST(zeroblob(32) || substr(cam_from_submap, 33) AS BLOB)";

// The pages are intact, but their content would crash the code that uses it.
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
                          "UPDATE links SET b_from_a = x'00'",
                          "UPDATE masks SET stream = -9",
                          "UPDATE masks SET utime = -1",
                          "UPDATE masks SET width = 1000000000000",
                          "UPDATE masks SET left_out = 1.5",
                          "UPDATE masks SET png = x''",
                          "UPDATE masks SET png = x'89504E47'"}) {
    const TemporaryFolder folder;
    {
      MapStore store = MapStore::open(folder / "map.db").value();
      ASSERT_EQ(store.save(merged_atlas(), {}).error_text(), "");
    }
    Database(folder / "map.db").execute(sql);
    EXPECT_THAT(open_error(folder / "map.db"), AllOf(HasSubstr("map.db"), HasSubstr("damaged"))) << sql;
  }
}

TEST(MapStore, FullDatabaseRefusesAndCatchesUpLater) {
  const TemporaryFolder folder;
  Atlas atlas;
  MapStore store = MapStore::open(folder / "map.db").value();
  SubmapMaker maker({7, 1}, 1);
  maker.step();
  update_atlas(&atlas, maker.submap());
  ASSERT_EQ(store.save(atlas, {}).error_text(), "");
  store.limit_bytes(1);
  for (int i = 0; i < 20; ++i) maker.step();
  update_atlas(&atlas, maker.submap());
  EXPECT_THAT(store.save(atlas, {}).error_text(), AllOf(HasSubstr("map.db"), HasSubstr("no space left")));
  EXPECT_EQ(store.stored_revision({7, 1}), 1);
  store.limit_bytes(int64_t{1} << 40);
  EXPECT_EQ(store.save(atlas, {}).error_text(), "");
  EXPECT_EQ(store.stored_revision({7, 1}), 21);
  expect_same(atlas, store.load().value());
}

// On a disk that is really full, everything accepted is there afterwards.
TEST(MapStore, FullDiskLosesNothingThatWasAccepted) {
  const TemporaryFolder folder;
  const int result = testing::run_on_small_disk(folder.path().string(), 400'000, [&] {
    Atlas atlas, accepted;
    SubmapMaker maker({7, 1}, 1);
    std::string problem;
    {
      MapStore store = MapStore::open(folder / "map.db").value();
      for (int i = 0; i < 500 && problem.empty(); ++i) {
        maker.step();
        update_atlas(&atlas, maker.submap());
        problem = store.save(atlas, {}).error_text();
        if (problem.empty()) update_atlas(&accepted, maker.submap());
      }
    }
    if (problem.find("map.db") == std::string::npos) return 1;
    if (problem.find("no space left") == std::string::npos) {
      std::fprintf(stderr, "%s\n", problem.c_str());
      return 2;
    }
    MapStore store = MapStore::open(folder / "map.db").value();
    expect_same(accepted, store.load().value());
    return ::testing::Test::HasFailure() ? 3 : 0;
  });
  if (result < 0) GTEST_SKIP() << "no user namespaces here: cannot mount a small disk";
  EXPECT_EQ(result, 0);
}

TEST(MapStore, AFolderOfSomebodyElseIsNamedWithItsOwner) {
  const TemporaryFolder folder;
  std::filesystem::permissions(folder.path(), std::filesystem::perms(0755));
  const std::string error = testing::as_ordinary_user([&] { return open_error(folder / "map.db"); });
  if (geteuid() != 0) GTEST_SKIP() << "the folder is one's own";
  EXPECT_THAT(error, AllOf(HasSubstr("in the folder " + folder.path().string() + ": Permission denied; "),
                           HasSubstr(" belongs to root (uid 0), and this is "),
                           HasSubstr("--set map_server.database=FILE, or start in a folder that you may write")));
}

TEST(MapStore, ReadOnlyFolderIsNamed) {
  const TemporaryFolder folder;
  const int result = testing::run_on_small_disk(folder.path().string(), 1'000'000, [&] {
    { MapStore store = MapStore::open(folder / "map.db").value(); }
    if (mount("tmpfs", folder.path().c_str(), "tmpfs", MS_REMOUNT | MS_RDONLY, nullptr) != 0) return 1;
    const std::string error = open_error(folder / "map.db");
    std::fprintf(stderr, "%s\n", error.c_str());
    return error.find("map.db.lock") != std::string::npos && error.find("Read-only") != std::string::npos ? 0 : 2;
  });
  if (result < 0) GTEST_SKIP() << "no user namespaces here: cannot mount a small disk";
  EXPECT_EQ(result, 0);
}

// Applies the next update. Every second time, places the map anew and replaces its link.
void grow_and_place(SubmapMaker* maker, Atlas* atlas) {
  maker->step();
  update_atlas(atlas, maker->submap());
  const Submap& submap = maker->submap();
  if (submap.revision % 2 != 0) return;
  Placement placement = make_placement(submap, static_cast<uint32_t>(submap.revision));
  placement.fused[submap.landmarks.begin()->first] = {submap.key, submap.landmarks.rbegin()->first};
  testing::place_map(atlas, {{submap.key, placement}});
  EXPECT_TRUE(atlas->set_links(
      {{.a = submap.key, .b = submap.key, .keyframes = static_cast<int>(submap.revision), .doubt = "self"}}));
}

// Run in a child: saves one update after another and reports each through a pipe, until it is killed.
void save_until_killed(const std::string& file, int pipe_end) {
  MapStore store = MapStore::open(file).value();
  Atlas atlas = store.load().value();
  SubmapMaker maker({7, 1}, 1);
  for (int64_t revision = 1;; ++revision) {
    grow_and_place(&maker, &atlas);
    if (!store.save(atlas, {}).error_text().empty()) _exit(1);
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
    // Waits for some saves, and kills the child at an arbitrary moment of a later one.
    while (accepted < 3 + 4 * round && read(ends[0], &revision, sizeof(revision)) == sizeof(revision))
      accepted = revision;
    usleep(1500 * round);
    ASSERT_EQ(kill(child, SIGKILL), 0);
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status)) << WEXITSTATUS(status);
    while (read(ends[0], &revision, sizeof(revision)) == sizeof(revision)) accepted = revision;
    close(ends[0]);

    MapStore store = MapStore::open(folder / "map.db").value();
    const Atlas loaded = store.load().value();
    const int64_t stored = store.stored_revision({7, 1});
    EXPECT_GE(stored, accepted);
    EXPECT_LE(stored, accepted + 1);  // one more if the child was killed between saving and reporting
    // Repeats the child's updates up to the stored one.
    Atlas expected;
    SubmapMaker maker({7, 1}, 1);
    for (int64_t i = 0; i < stored; ++i) grow_and_place(&maker, &expected);
    expect_same(expected, loaded);
  }
}

}  // namespace
}  // namespace rumi::map_server
