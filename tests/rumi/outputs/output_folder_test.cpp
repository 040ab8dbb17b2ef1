// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "map_server/store/map_store.h"
#include "rumi/outputs/map_file.h"
#include "rumi/outputs/output_folder.h"
#include "rumi/outputs/run_summary.h"
#include "tests/map_server/place_map.h"
#include "tests/rumi/small_atlas.h"
#include "tests/support/temporary_folder.h"

namespace rumi::tool {
namespace {

namespace fs = std::filesystem;
using namespace std::string_literals;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::ThrowsMessage;

nlohmann::json read_json(const fs::path& file) {
  std::ifstream in(file);
  return nlohmann::json::parse(in, nullptr, false);
}

TEST(OutputFolder, IsMadeAndMarkedAsOurs) {
  const testing::TemporaryFolder temporary;
  const fs::path folder = temporary.path() / "deep" / "er";
  EXPECT_EQ(prepare_output_folder(folder.string()).error_text(), "");
  EXPECT_EQ(read_json(folder / "run.json")["program"], "rumi");
  EXPECT_EQ(read_json(folder / "run.json")["finished"], false);
  EXPECT_EQ(prepare_output_folder(folder.string()).error_text(), "") << "of an earlier run";
}

TEST(OutputFolder, NamesThatAreNoUtf8AreInRunJson) {
  const testing::TemporaryFolder temporary;
  const fs::path& folder = temporary.path();
  EXPECT_EQ(write_run_json(folder.string(), {{"input",
                                              "K\xfc"
                                              "che"}})
                .error_text(),
            "");
  EXPECT_EQ(read_json(folder / "run.json")["input"],
            "K\xef\xbf\xbd"
            "che");
}

TEST(OutputFolder, OptionsThatAreNoUtf8AreInRunJson) {
  const testing::TemporaryFolder temporary;
  const fs::path& folder = temporary.path();
  const auto options = options_to_json(
      "camera_driver:\n  camera_file: \"K\xfc"
      "che.yaml\"\n");
  EXPECT_EQ(write_run_json(folder.string(), {{"options", options}}).error_text(), "");
  EXPECT_EQ(read_json(folder / "run.json")["options"]["camera_driver"]["camera_file"],
            "K\xef\xbf\xbd"
            "che.yaml");
}

TEST(OutputFolder, TheMapThatIsReadIsNotReplaced) {
  const testing::TemporaryFolder temporary;
  const fs::path& folder = temporary.path();
  const std::string database = (folder / "map.db").string();
  std::ofstream(database) << "a map";
  fs::create_symlink(folder, folder / "other_name");
  fs::create_symlink(database, folder / "link.db");
  for (const fs::path& name : {folder / "map.db", folder / "." / "map.db", folder / "other_name" / "map.db",
                               folder / "link.db", fs::relative(folder / "map.db")})
    EXPECT_THAT(check_map_stays(name.string(), folder.string()).error_text(), HasSubstr("choose another folder"))
        << name;
  EXPECT_EQ(check_map_stays(database, (folder / "out").string()).error_text(), "");
  EXPECT_EQ(check_map_stays((folder / "other.db").string(), folder.string()).error_text(), "");
}

TEST(OutputFolder, WhereAMapServerHasItsMapIsRefused) {
  const testing::TemporaryFolder temporary;
  const fs::path& folder = temporary.path();
  ASSERT_EQ(prepare_output_folder(folder.string()).error_text(), "");
  {
    const map_server::MapStore store = map_server::MapStore::open((folder / "map.db").string()).value();
    EXPECT_THAT(check_output_folder(folder.string()).error_text(), HasSubstr("has the map open"));
  }
  EXPECT_EQ(check_output_folder(folder.string()).error_text(), "");
}

TEST(OutputFolder, OtherFilesAreLeftAlone) {
  const testing::TemporaryFolder temporary;
  const fs::path& folder = temporary.path();
  fs::create_directories(folder / "submaps");
  fs::create_directories(folder / "windows");
  for (const char* name : {"log.txt", "map.db.old", "submaps/notes.txt", "windows/kitchen.png"})
    std::ofstream(folder / name) << "somebody's work\n";
  EXPECT_EQ(prepare_output_folder(folder.string()).error_text(), "");
  EXPECT_EQ(read_json(folder / "run.json")["program"], "rumi");
  EXPECT_TRUE(fs::exists(folder / "log.txt"));
}

TEST(OutputFolder, IsRefusedForWhatWouldBeOverwritten) {
  for (const char* name :
       {"trajectory.txt", "trajectory.png", "trajectory.mp4", "frames.csv", "map.db", "map.ply", "windows.csv",
        "run.json", "submaps/001.txt", "submaps/s2-b012.txt", "windows/1-2.window", "pictures/000001.png"}) {
    const testing::TemporaryFolder temporary;
    const fs::path& folder = temporary.path();
    fs::create_directories((folder / name).parent_path());
    std::ofstream(folder / name) << "somebody's work\n";
    std::ofstream(folder / "log.txt") << "and more of it\n";
    const std::string error = prepare_output_folder(folder.string()).error_text();
    EXPECT_THAT(error, AllOf(HasSubstr(std::string(name) + " would be overwritten"), Not(HasSubstr("log.txt"))));
    EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 2) << "nothing was added";
  }
}

TEST(OutputFolder, NamesSomeOfTheFilesThatItIsRefusedFor) {
  const testing::TemporaryFolder temporary;
  const fs::path& folder = temporary.path();
  for (const char* name : {"trajectory.txt", "map.db", "map.ply", "frames.csv", "windows.csv"})
    std::ofstream(folder / name) << "somebody's work\n";
  std::ofstream(folder / "run.json") << "{\"program\": \"of somebody else\"}";
  EXPECT_THAT(prepare_output_folder(folder.string()).error_text(),
              HasSubstr("frames.csv, map.db, map.ply and 3 more would be overwritten"));
}

TEST(OutputFolder, SaysWhyItCannotBeMade) {
  const testing::TemporaryFolder temporary;
  const fs::path& folder = temporary.path();
  std::ofstream(folder / "file") << "x";
  EXPECT_THAT(prepare_output_folder((folder / "file").string()).error_text(),
              HasSubstr("file: cannot be made a folder"));
  EXPECT_THAT(prepare_output_folder((folder / "file" / "below").string()).error_text(),
              HasSubstr("cannot be made a folder"));
  EXPECT_NE(prepare_output_folder("/proc/no_such_thing").error_text(), "") << "nobody can write there, not even root";
}

TEST(RunJson, OptionsKeepTheirTypes) {
  const auto json = options_to_json("a:\n  i: 3\n  d: 0.5\n  b: true\n  s: \"17\"\n  e: \"\"\n");
  EXPECT_EQ(json["a"]["i"], 3);
  EXPECT_EQ(json["a"]["d"], 0.5);
  EXPECT_EQ(json["a"]["b"], true);
  EXPECT_EQ(json["a"]["s"], "17");
  EXPECT_EQ(json["a"]["e"], "");
}

class MapFileTest : public ::testing::Test {
 protected:
  const testing::TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path();
  std::string file_ = (folder_ / "map.db").string();
};

TEST_F(MapFileTest, IsReadWhileAMapServerHasItOpenAndStaysUntouched) {
  map_server::MapStore store = map_server::MapStore::open(file_).value();
  const map_server::Atlas atlas = make_test_atlas();
  ASSERT_EQ(store.save(atlas, {{1'000'000}, {1'400'000}}).error_text(), "");
  const map_server::Atlas loaded = load_map(file_);
  ASSERT_EQ(loaded.submaps().size(), 1u);
  EXPECT_EQ(loaded.submaps().begin()->second.submap.keyframes.size(), 4u);
  EXPECT_EQ(loaded.frames_in_map(), 4);
  // The server can still save.
  map_server::Atlas more = make_test_atlas();
  EXPECT_EQ(store.save(more, {ImageId{1'100'000}}).error_text(), "");
}

TEST_F(MapFileTest, NothingIsLeftBesideTheFile) {
  { ASSERT_EQ(map_server::MapStore::open(file_).value().save(make_test_atlas(), {}).error_text(), ""); }
  load_map(file_);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);
}

TEST_F(MapFileTest, ABusyFileIsSaidToBeBusy) {
  { ASSERT_EQ(map_server::MapStore::open(file_).value().save(make_test_atlas(), {}).error_text(), ""); }
  Database holder(file_);
  holder.execute("PRAGMA locking_mode = EXCLUSIVE; BEGIN EXCLUSIVE");
  EXPECT_THAT([&] { load_map(file_, std::chrono::milliseconds(5)); },
              ThrowsMessage<std::runtime_error>(HasSubstr("map.db is busy")));
}

TEST_F(MapFileTest, SaysWhatIsWrongWithTheFile) {
  EXPECT_THAT([&] { load_map(file_); }, ThrowsMessage<std::runtime_error>(HasSubstr("no such file")));
  std::ofstream(file_) << "not a database, but long enough to be taken for one by a careless reader";
  EXPECT_THAT([&] { load_map(file_); }, ThrowsMessage<std::runtime_error>(HasSubstr("map.db")));
}

TEST_F(MapFileTest, OutputsAreWhatTheAtlasHolds) {
  const map_server::Atlas atlas = make_test_atlas();
  EXPECT_THAT(write_run_outputs(atlas, folder_.string()), IsEmpty());
  for (const char* name : {"trajectory.txt", "submaps/001.txt", "frames.csv", "map.ply"}) {
    EXPECT_TRUE(fs::exists(folder_ / name)) << name;
  }
  const AtlasCounts counts = count(atlas);
  EXPECT_EQ(counts.frames, 5);
  EXPECT_EQ(counts.frames_in_map, 4);
  EXPECT_EQ(counts.tracked_frames, 4);
  EXPECT_EQ(counts.submaps, 1);
  EXPECT_EQ(counts.keyframes, 4);
  EXPECT_EQ(counts.landmarks, 20);
}

TEST_F(MapFileTest, PicturesShowWhatIsInTheMapWhereItLies) {
  map_server::Atlas atlas = make_test_atlas();
  Submap other = make_test_submap();
  other.key = {1, 2};
  EXPECT_TRUE(atlas.change_submap(other.key, [&](Submap* submap) {
    *submap = other;
    return Result<>();
  }));
  map_server::Placement placement;
  placement.map_from_submap[0] = Sim3(2, Eigen::Quaterniond::Identity(), {10, 0, 0});
  testing::place_map(&atlas, {{{1, 1}, placement}});
  const AtlasPicture shown = make_picture(atlas, "title");
  ASSERT_EQ(shown.picture.submaps.size(), 2u);
  EXPECT_TRUE(shown.picture.submaps[0].in_map);
  EXPECT_FALSE(shown.picture.submaps[1].in_map);
  const Eigen::Vector3d raw = other.landmarks.at(3).position;
  EXPECT_EQ(shown.picture.submaps[0].submap->landmarks.at(3).position, 2 * raw + Eigen::Vector3d(10, 0, 0));
  EXPECT_EQ(shown.picture.submaps[1].submap->landmarks.at(3).position, raw);
  EXPECT_EQ(shown.picture.frames.size(), 5u);
}

TEST(DescribeProgress, TellsTheTimeLeftWhereTheEndIsKnown) {
  EXPECT_EQ(describe_progress(512, 1000, 6.4), "512 of 1000 images, 80.0 per second, about 7 s left");
  EXPECT_EQ(describe_progress(512, -1, 6.4), "512 images, 80.0 per second");
  EXPECT_EQ(describe_progress(0, 1000, 0), "0 of 1000 images, 0.0 per second");
}

TEST(LeftOut, NothingOfAMapOfAllFrames) {
  map_server::Atlas atlas;
  const Submap submap = make_test_submap();
  EXPECT_TRUE(atlas.change_submap(submap.key, [&](Submap* target) {
    *target = submap;
    return Result<>();
  }));
  EXPECT_TRUE(left_out(atlas).empty());
  EXPECT_TRUE(left_out(map_server::Atlas()).empty());
}

TEST(LeftOut, FramesWithoutAPoseByWhereTheyAre) {
  map_server::Atlas atlas = make_test_atlas();  // has poses from 1.0 to 1.3 s, and then a lost frame
  for (const int64_t utime_us : {700'000, 800'000, 1'140'000, 1'160'000, 1'250'000})
    atlas.record_frame({utime_us}, {1, TrackingState::kNotInitialized, kNoSubmap});
  EXPECT_THAT(left_out(atlas), ElementsAre("6 frames have no pose: 2 before the first submap, 3 in 2 gaps (the longest "
                                           "0.06 s, from 0.44 s on), 1 at the end"));
}

TEST(LeftOut, SubmapsThatAreNotInTheMapAndWhy) {
  map_server::Atlas atlas = make_test_atlas();
  for (int id = 2; id <= 4; ++id) {
    Submap other = make_test_submap(3);
    other.key = {1, id};
    FrameTable frames;
    for (const auto& [utime_us, frame] : other.frames) {
      FramePose later = frame;
      later.utime_us += id * 10'000'000;
      frames.set(later);
    }
    other.frames = frames;
    EXPECT_TRUE(atlas.change_submap(other.key, [&](Submap* submap) {
      *submap = other;
      return Result<>();
    }));
  }
  const auto link = [](int a, int b, const std::string& doubt) {
    return map_server::Link{.a = {1, a}, .b = {1, b}, .doubt = doubt};
  };
  EXPECT_TRUE(atlas.set_links({link(1, 2, "3 of 10 shared keyframes agree"), link(3, 4, "")}));
  EXPECT_THAT(left_out(atlas),
              ElementsAre("1 frame has no pose: 1 in a gap (19.60 s, from 0.40 s on)"s,
                          "3 frames of submap 2: its link to submap 1 is refused: 3 of 10 shared keyframes agree"s,
                          "3 frames of submap 3: it is linked to submap 4 only, which is not in the map either"s,
                          "3 frames of submap 4: it is linked to submap 3 only, which is not in the map either"s));
}

}  // namespace
}  // namespace rumi::tool
