// SPDX-License-Identifier: BSD-3-Clause
// Runs `rumi replay` on a recording, and reads the outputs.
#include <gmock/gmock.h>

#include <algorithm>
#include <sstream>

#include "tests/rumi/commands/replay_fixture.h"

namespace rumi::tool {
namespace {

using ::testing::HasSubstr;

TEST_F(ReplayTest, TracksARenderedRoomTheSameToTheBitEveryTime) {
  const fs::path first = work_->path() / "first", second = work_->path() / "second";
  const Outcome outcome = replay(sequence_, first);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  ASSERT_EQ(replay(sequence_, second).exit_code, 0);
  for (const char* name :
       {"trajectory.txt", "submaps/001.txt", "frames.csv", "map.db", "map.ply", "trajectory.png", "run.json"}) {
    EXPECT_TRUE(fs::exists(first / name)) << name;
  }
  expect_same(first, second);

  const auto figures = evaluate(first, sequence_ / "groundtruth.txt");
  EXPECT_EQ(figures["frames"], 240);
  EXPECT_GE(figures["tracked_frame_ratio"], 0.9);
  EXPECT_GE(figures["true_rate"], 0.9);
  EXPECT_LE(figures["ate_rmse_m"], 0.05);
  EXPECT_TRUE(fs::exists(first / "evaluation.png"));
}

// Returns a shell command that starts a replay into `out`, and runs `kill` as soon as run.json is there.
std::string interrupted(const fs::path& sequence, const fs::path& out, const std::string& kill) {
  return "$RUMI/rumi replay '" + sequence.string() + "' -o '" + out.string() + "' & pid=$!; while [ ! -f '" +
         (out / "run.json").string() + "' ]; do kill -0 $pid || exit 99; done; " + kill + "; wait $pid";
}

TEST_F(ReplayTest, CtrlCEndsItThereAndWhatThereIsIsWritten) {
  for (const char* signal : {"INT", "TERM"}) {
    const fs::path out = work_->path() / (std::string("interrupted_") + signal);
    const Outcome outcome = shell(interrupted(sequence_, out, std::string("kill -") + signal + " $pid"));
    EXPECT_EQ(outcome.exit_code, 3) << outcome.output;
    EXPECT_THAT(outcome.output, HasSubstr("rumi replay: ended by "));
    EXPECT_THAT(outcome.output, HasSubstr(" of 240 images; "));
    for (const char* name : {"trajectory.txt", "frames.csv", "map.db", "map.ply", "trajectory.png"})
      EXPECT_TRUE(fs::exists(out / name)) << name;
    const auto run = read_json_file(out / "run.json");
    EXPECT_EQ(run["finished"], true);
    EXPECT_EQ(run["stopped_early"], true);
    EXPECT_LT(run["images"], 240);
    EXPECT_EQ(shell("$RUMI/rumi report '" + out.string() + "'").exit_code, 0);
  }
}

TEST_F(ReplayTest, WhoAsksTwiceWaitsForNobody) {
  const fs::path out = work_->path() / "interrupted_twice";
  const Outcome outcome = shell(interrupted(sequence_, out, "kill -TERM $pid; kill -INT $pid"));
  EXPECT_THAT(outcome.exit_code, ::testing::AnyOf(130, 143)) << outcome.output;
  EXPECT_FALSE(fs::exists(out / "map.db"));
}

TEST_F(ReplayTest, WithoutAPictureAllElseIsKept) {
  const fs::path out = work_->path() / "no_picture";
  const Outcome outcome = shell("RUMI_OPENGL=none $RUMI/rumi replay -q --duration 1 '" + sequence_.string() + "' -o '" +
                                out.string() + "'");
  EXPECT_EQ(outcome.exit_code, 1) << outcome.output;
  EXPECT_THAT(outcome.output, HasSubstr("there is no picture "));
  EXPECT_THAT(outcome.output, HasSubstr("RUMI_OPENGL is 'none'"));
  for (const char* name : {"trajectory.txt", "frames.csv", "map.db", "map.ply"})
    EXPECT_TRUE(fs::exists(out / name)) << name;
  EXPECT_FALSE(fs::exists(out / "trajectory.png"));
  EXPECT_EQ(read_json_file(out / "run.json")["missing"].size(), 1);
}

// COLMAP finds the images of a folder by their names, and those of a log in the folder into which they were written.
TEST_F(ReplayTest, ColmapFindsTheImagesOfAModel) {
  const fs::path out = work_->path() / "for_colmap", log = work_->path() / "for_colmap.lcm";
  ASSERT_EQ(replay(sequence_, out, "--duration 3 --set image.max_image_side=500").exit_code, 0);
  ASSERT_EQ(shell("$RUMI/rumi export '" + sequence_.string() + "' -o '" + log.string() + "'").exit_code, 0);
  ASSERT_EQ(replay(log, out.string() + "_log", "--duration 3").exit_code, 0);
  struct {
    std::string map, images, image_folder;
  } cases[] = {{out.string(), sequence_.string(), (sequence_ / "rgb").string()},
               {out.string() + "_log", log.string(), out.string() + "_log_model/images"}};
  for (const auto& [map, images, image_folder] : cases) {
    const std::string model = map + "_model", undistorted = map + "_undistorted";
    const Outcome exported =
        shell("$RUMI/rumi export-map '" + map + "' -o '" + model + "' --format colmap-text --images '" + images + "'");
    ASSERT_EQ(exported.exit_code, 0) << exported.output;
    EXPECT_THAT(exported.output, HasSubstr("--image_path " + image_folder + "\n"));
    std::istringstream lines(read_file(fs::path(model) / "images.txt"));
    int64_t count = 0;
    for (std::string line, points; std::getline(lines, line);) {
      if (line.starts_with("#")) continue;
      EXPECT_TRUE(fs::exists(fs::path(image_folder) / line.substr(line.rfind(' ') + 1))) << line;
      std::getline(lines, points);
      ++count;
    }
    ASSERT_GE(count, 3);
    if (shell("command -v colmap").exit_code != 0) continue;
    const Outcome colmap = shell("QT_QPA_PLATFORM=offscreen colmap image_undistorter --image_path '" + image_folder +
                                 "' --input_path '" + model + "' --output_path '" + undistorted + "'");
    EXPECT_EQ(colmap.exit_code, 0) << colmap.output;
    EXPECT_EQ(std::distance(fs::directory_iterator(fs::path(undistorted) / "images"), {}), count) << colmap.output;
    const Outcome analyzed = shell("QT_QPA_PLATFORM=offscreen colmap model_analyzer --path '" + model + "'");
    EXPECT_THAT(analyzed.output, HasSubstr("Registered images: " + std::to_string(count)));
  }
}

TEST_F(ReplayTest, TheLogOfARunCanBeReplayedToTheSameResult) {
  const fs::path first = work_->path() / "recorded", second = work_->path() / "from_log",
                 log = work_->path() / "bus.lcm";
  const std::string flag = "--log '" + log.string() + "'";
  ASSERT_EQ(replay(sequence_, first, "--duration 3 " + flag).exit_code, 0);
  const std::string bytes = read_file(log);
  for (const char* channel : {"CAMERA", "RUMI_TRACK", "RUMI_MAP_STATUS", "VIEWER_IMAGE"})
    EXPECT_NE(bytes.find(channel), std::string::npos) << channel;
  EXPECT_EQ(bytes.find("RUMI_MAP_CHUNK"), std::string::npos);
  EXPECT_EQ(bytes.find("RUMI_SUBMAP"), std::string::npos);
  ASSERT_EQ(replay(log, second).exit_code, 0);
  // The viewer only draws if its pictures are kept.
  EXPECT_TRUE(read_json_file(first / "run.json")["cpu_ms_per_frame"].contains("viewer_offscreen"));
  EXPECT_FALSE(read_json_file(second / "run.json")["cpu_ms_per_frame"].contains("viewer_offscreen"));
  EXPECT_EQ(read_file(first / "trajectory.txt"), read_file(second / "trajectory.txt"));

  const Outcome itself = replay(log, second, flag);
  EXPECT_EQ(itself.exit_code, 1);
  EXPECT_THAT(itself.output, HasSubstr("input itself"));
  EXPECT_TRUE(read_file(log) == bytes) << "it must survive that";
  EXPECT_EQ(replay(sequence_, second, "--log /proc/bus.lcm").exit_code, 1);
  const Outcome no_loss =
      shell("$RUMI/rumi draw-window '" + log.string() + "' -o '" + (second / "w.png").string() + "'");
  EXPECT_EQ(no_loss.exit_code, 1);
  EXPECT_THAT(no_loss.output, HasSubstr("no window"));
}

TEST_F(ReplayTest, LocalizesInTheMapOfAnEarlierRun) {
  const fs::path first = work_->path() / "to_localize_in", second = work_->path() / "localized", map = first / "map.db";
  ASSERT_EQ(replay(sequence_, first, "--duration 5").exit_code, 0);
  const std::string bytes = read_file(map);
  const std::string flags = "--start 3 --set map_server.localize_only=true --set map_server.database=";
  const Outcome outcome = replay(sequence_, second, flags + "'" + map.string() + "'");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_TRUE(read_file(map) == bytes);
  const auto figures = evaluate(second, sequence_ / "groundtruth.txt");
  EXPECT_EQ(figures["frames"], 150) << "those of this run";
  EXPECT_GE(figures["tracked_frames"], 0.95 * 150);
  EXPECT_GE(figures["true_rate"], 0.9);
  EXPECT_LE(figures["ate_rmse_m"], 0.05);
  const auto run = read_json_file(second / "run.json");
  EXPECT_EQ(run["counts"]["localized_frames"], figures["tracked_frames"]);
  EXPECT_TRUE(run["localized_after_s"].is_number());
  EXPECT_LE(run["localized_after_s"], 2.0) << "it looks at what the map was made of";

  const Outcome absent = replay(sequence_, second, flags + "absent.db");
  EXPECT_EQ(absent.exit_code, 1);
  EXPECT_THAT(absent.output, HasSubstr("absent.db: there is no such file"));
}

// The two folders have different images, but the times of both begin at 0.
TEST_F(ReplayTest, AFolderIsLocalizedInTheMapOfAnotherFolder) {
  std::vector<fs::path> images;
  for (const auto& entry : fs::directory_iterator(sequence_ / "rgb")) images.push_back(entry.path());
  std::sort(images.begin(), images.end());
  const auto make_folder = [&](const char* name, size_t first, size_t last) {
    const fs::path folder = work_->path() / name;
    fs::create_directories(folder);
    fs::copy_file(sequence_ / "calibration.yaml", folder / "calibration.yaml");
    for (size_t i = first; i < last; ++i)
      fs::create_symlink(images[i], folder / (std::to_string(1000 + i - first) + images[i].extension().string()));
    return folder;
  };
  ASSERT_GE(images.size(), 200u);
  const fs::path one = make_folder("folder_one", 0, 130), other = make_folder("folder_other", 80, 200);
  const fs::path mapped = work_->path() / "mapped_one", localized = work_->path() / "localized_other";
  ASSERT_EQ(replay(one, mapped).exit_code, 0);
  const Outcome outcome =
      replay(other, localized,
             "--set map_server.localize_only=true --set map_server.database='" + (mapped / "map.db").string() + "'");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_THAT(outcome.output, ::testing::Not(HasSubstr("not everything could be handed on")));
  const auto counts = read_json_file(localized / "run.json")["counts"];
  EXPECT_EQ(counts["earlier_frames"], 130);
  EXPECT_EQ(counts["frames"], 120);
  EXPECT_GE(counts["frames_in_map"], 108);
}

TEST_F(ReplayTest, WhereNothingLooksLikeTheMapItIsSaid) {
  const fs::path map = work_->path() / "map_of_one_room", out = work_->path() / "not_found";
  const TemporaryFolder elsewhere;
  const fs::path other = render(elsewhere, "--seconds 3 --seed 9");
  ASSERT_EQ(replay(sequence_, map, "--duration 3").exit_code, 0);
  const Outcome outcome = replay(
      other, out, "--set map_server.localize_only=true --set map_server.database='" + (map / "map.db").string() + "'");
  EXPECT_EQ(outcome.exit_code, 3) << outcome.output;
  EXPECT_THAT(outcome.output, HasSubstr("not localized: nothing in this recording looks like"));
  EXPECT_EQ(fs::file_size(out / "trajectory.txt"), 0);
  EXPECT_GE(read_json_file(out / "run.json")["counts"]["tracked_frames"], 60) << "in a submap of their own";
}

TEST_F(ReplayTest, AMapGoesToOtherPrograms) {
  const fs::path out = work_->path() / "map", model = work_->path() / "model";
  ASSERT_EQ(replay(sequence_, out, "--duration 4").exit_code, 0);
  const Outcome outcome =
      shell("$RUMI/rumi export-map '" + (out / "map.db").string() + "' -o '" + model.string() +
            "' --format tum && $RUMI/rumi export-map '" + (out / "map.db").string() + "' -o '" + model.string() +
            "' --format colmap-text && colmap model_analyzer --path '" + model.string() + "'");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_EQ(read_file(model / "trajectory.txt"), read_file(out / "trajectory.txt")) << "the database forgot something";
  EXPECT_THAT(outcome.output, HasSubstr("Registered images"));
}

TEST_F(ReplayTest, TheMapHasTheColoursOfTheImagesAtOnceAndAfterwards) {
  const fs::path out = work_->path() / "coloured", with = work_->path() / "with", without = work_->path() / "without";
  ASSERT_EQ(replay(sequence_, out, "--duration 3").exit_code, 0);
  const std::string write_ply = "$RUMI/rumi export-map '" + out.string() + "' --format ply -o ";
  Outcome outcome = shell(write_ply + "'" + with.string() + "' --images '" + sequence_.string() + "'");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_THAT(outcome.output, HasSubstr("images of keyframes"));
  ASSERT_EQ(shell(write_ply + "'" + without.string() + "'").exit_code, 0);
  EXPECT_TRUE(read_file(with / "map.ply") == read_file(out / "map.ply"));
  EXPECT_FALSE(read_file(without / "map.ply") == read_file(out / "map.ply"));

  const fs::path other = work_->path() / "other_recording";
  ASSERT_EQ(shell("$RUMI/rumi synth -q --seconds 1 --seed 9 -o '" + other.string() + "'").exit_code, 0);
  outcome = shell(write_ply + "'" + with.string() + "' --images '" + other.string() + "'");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.output, HasSubstr("other_recording: has none of the"));
}

TEST_F(ReplayTest, SaysWhatIsWrongWithTheInput) {
  const auto refused = [&](const fs::path& input, const std::string& flags = "") {
    const fs::path out = work_->path() / "never";
    const Outcome outcome = replay(input, out, flags);
    EXPECT_NE(outcome.exit_code, 0) << outcome.output;
    EXPECT_FALSE(fs::exists(out / "trajectory.txt"));
    return outcome.output;
  };
  EXPECT_THAT(refused(work_->path() / "absent"), HasSubstr("absent"));

  const fs::path empty = work_->path() / "empty";
  fs::create_directories(empty);
  fs::copy(sequence_ / "calibration.yaml", empty / "calibration.yaml");
  std::ofstream(empty / "rgb.txt") << "# timestamp filename\n";
  EXPECT_THAT(refused(empty), HasSubstr("rgb.txt"));

  std::ofstream(work_->path() / "nan.yaml")
      << "fx: .nan\nfy: 525\ncx: 320\ncy: 240\nk1: 0\nk2: 0\np1: 0\np2: 0\nk3: 0\nwidth: 640\nheight: 480\n";
  EXPECT_THAT(refused(sequence_, "--camera '" + (work_->path() / "nan.yaml").string() + "'"), HasSubstr("fx"));
  std::ofstream(work_->path() / "small.yaml")
      << "fx: 262\nfy: 262\ncx: 160\ncy: 120\nk1: 0\nk2: 0\np1: 0\np2: 0\nk3: 0\nwidth: 320\nheight: 240\n";
  EXPECT_THAT(refused(sequence_, "--camera '" + (work_->path() / "small.yaml").string() + "'"), HasSubstr("320"));

  EXPECT_THAT(refused(sequence_, "--set front_tracker.keypoint=5"), HasSubstr("front_tracker.keypoints"));
  EXPECT_THAT(refused(sequence_, "--config /no/such.yaml"), HasSubstr("/no/such.yaml"));
}

TEST_F(ReplayTest, WhatIsLeftOutIsToldByTheExitCodeToo) {
  const fs::path damaged = work_->path() / "damaged", out = work_->path() / "of_damaged";
  fs::copy(sequence_, damaged, fs::copy_options::recursive);
  int number = 0;
  for (const auto& entry : fs::directory_iterator(damaged / "rgb"))
    if (number++ % 10 == 5) fs::resize_file(entry.path(), 100);
  const Outcome outcome = replay(damaged, out);
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.output, HasSubstr("24 of 240 images (10 %) were left out"));
  EXPECT_TRUE(fs::exists(out / "map.db"));
  EXPECT_GE(read_json_file(out / "run.json")["images"], 216);
  const Outcome exported =
      shell("$RUMI/rumi export '" + damaged.string() + "' -o '" + (work_->path() / "damaged.lcm").string() + "'");
  EXPECT_EQ(exported.exit_code, 3);
  EXPECT_THAT(exported.output, HasSubstr("24 of 240 images"));
}

// The files are complete, so the damage is found only when they are decoded.
TEST_F(ReplayTest, ImagesDamagedInTheMiddleCountAsLeftOut) {
  const fs::path damaged = work_->path() / "damaged_inside", out = work_->path() / "of_damaged_inside";
  fs::copy(sequence_, damaged, fs::copy_options::recursive);
  int number = 0;
  for (const auto& entry : fs::directory_iterator(damaged / "rgb")) {
    if (number++ % 10 != 5) continue;
    std::fstream file(entry.path(), std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(static_cast<std::streamoff>(fs::file_size(entry.path()) / 2));
    file << std::string(500, '\0');
  }
  const Outcome outcome = replay(damaged, out, "--duration 4");
  EXPECT_EQ(outcome.exit_code, 3) << outcome.output;
  EXPECT_THAT(outcome.output, HasSubstr("%) were left out"));
  EXPECT_GT(read_json_file(out / "run.json")["skipped_images"]["unreadable"], 0);
}

TEST_F(ReplayTest, IfNothingIsTrackedItSaysWhatTheImagesLookLike) {
  const fs::path dark = work_->path() / "dark";
  fs::create_directories(dark / "rgb");
  fs::copy(sequence_ / "calibration.yaml", dark / "calibration.yaml");
  std::ofstream list(dark / "rgb.txt");
  for (int i = 0; i < 20; ++i) {
    const std::string name = "rgb/" + std::to_string(i) + ".pgm";
    list << 0.1 * i << ' ' << name << '\n';
    std::ofstream(dark / name) << "P5 640 480 255\n" << std::string(640 * 480, '\2');
  }
  list.close();
  const Outcome outcome = replay(dark, work_->path() / "of_dark");
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.output, HasSubstr("no image has a pose: the images are black"));
}

// Each image has a pose with its time in the recording, and the two sessions are joined to one map.
TEST_F(ReplayTest, AClockThatIsSetBackIsTwoSessionsInOneMap) {
  const fs::path recording = work_->path() / "set_back", out = work_->path() / "of_set_back";
  fs::copy(sequence_, recording, fs::copy_options::recursive);
  std::istringstream before(read_file(sequence_ / "rgb.txt"));
  std::ofstream list(recording / "rgb.txt");
  int number = 0;
  for (std::string line; std::getline(before, line);) {
    if (line.empty() || line[0] == '#') continue;
    const size_t space = line.find(' ');
    list << std::to_string(std::stod(line.substr(0, space)) + (number++ < 120 ? 5000 : 1000)) << line.substr(space)
         << '\n';
  }
  list.close();
  const Outcome outcome = replay(recording, out);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_THAT(outcome.output, HasSubstr("the clock was set back by"));
  const auto counts = read_json_file(out / "run.json")["counts"];
  EXPECT_GE(counts["frames_in_map"], 235) << counts;
  EXPECT_EQ(counts["frames"], 240);
}

TEST_F(ReplayTest, OverwritesNothingButItsOwn) {
  const fs::path foreign = work_->path() / "foreign";
  fs::create_directories(foreign);
  std::ofstream(foreign / "trajectory.txt") << "the only copy";
  const Outcome mixed = replay(sequence_, foreign);
  EXPECT_EQ(mixed.exit_code, 1);
  EXPECT_THAT(mixed.output, HasSubstr("trajectory.txt would be overwritten"));
  EXPECT_EQ(std::distance(fs::directory_iterator(foreign), {}), 1);
  EXPECT_EQ(replay(sequence_, "/proc/rumi").exit_code, 1);
}

TEST_F(ReplayTest, WhatItSaysMayGoIntoItsFolder) {
  const fs::path out = work_->path() / "with_log";
  fs::create_directories(out);
  const std::string command = "$RUMI/rumi replay '" + sequence_.string() + "' -o '" + out.string() + "' --duration 2";
  const Outcome outcome = shell(command + " > '" + (out / "log.txt").string() + "'");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_TRUE(fs::exists(out / "trajectory.txt"));
  EXPECT_THAT(read_file(out / "log.txt"), HasSubstr("frames have a pose in the map"));
}

}  // namespace
}  // namespace rumi::tool
