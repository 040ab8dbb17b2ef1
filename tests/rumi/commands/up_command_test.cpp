// SPDX-License-Identifier: BSD-3-Clause
// Runs the five processes over real LCM multicast. It needs a network namespace (tests/run_in_netns.sh).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <thread>

#include "bus/process/process.h"
#include "bus/transport/lcm_bus.h"
#include "bus/transport/log_file.h"
#include "lcmtypes/rumi/image_t.hpp"
#include "tests/rumi/commands/end_to_end.h"

namespace rumi::tool {
namespace {

namespace fs = std::filesystem;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;

class LiveTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    work_ = new TemporaryFolder;
    sequence_ = render(*work_, "--seconds 8");
  }
  static void TearDownTestSuite() { delete work_; }

  static std::string up(const fs::path& out, const std::string& flags) {
    fs::create_directories(out.string() + "-view");
    return "$RUMI/rumi up '" RUMI_CONFIG "' '" + sequence_.string() + "' --snapshot '" + out.string() +
           "' --set map_server.database='" + out.string() + "-live.db' --set viewer_offscreen.output='" + out.string() +
           "-view' --set ruminator.spool='" + out.string() + "-spool' " + flags;
  }
  // Runs `rumi up`, and the shell command `then` as soon as submap 1 begins. In it, $up is the process of `rumi up`,
  // and $log the file with its output.
  static Outcome up_and(const fs::path& out, const std::string& flags, const std::string& then) {
    return shell(
        "log='" + out.string() + ".log'; " + up(out, flags) +
        " >\"$log\" 2>&1 & up=$!; while kill -0 $up && ! grep -q 'submap 1 begins' \"$log\"; do sleep 0.1; done; " +
        then + "; wait $up; code=$?; cat \"$log\"; exit $code");
  }
  static void expect_tracked(const fs::path& out) {
    const auto figures = evaluate(out, sequence_ / "groundtruth.txt");
    EXPECT_EQ(figures["frames"], 240) << "every image was answered";
    EXPECT_GE(figures["tracked_frame_ratio"], 0.9);
    EXPECT_LE(figures["ate_rmse_m"], 0.05);
  }
  static TemporaryFolder* work_;
  static fs::path sequence_;
};
TemporaryFolder* LiveTest::work_ = nullptr;
fs::path LiveTest::sequence_;

TEST_F(LiveTest, RunsToTheEndOfTheRecordingAndLosesNothing) {
  const fs::path out = work_->path() / "live";
  const Outcome outcome = shell(up(out, ""));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  expect_tracked(out);
  const auto run = read_json_file(out / "run.json");
  for (const char* process : {"front_tracker", "map_server"}) {
    ASSERT_TRUE(run["processes"].contains(process)) << run.dump(1);
  }
  for (const auto& [process, status] : run["processes"].items()) {
    for (const auto& [channel, counts] : status["channels"].items()) {
      // The viewer draws only the latest image. On a busy machine it skips some, which does no harm.
      if (process != "viewer_offscreen") {
        EXPECT_EQ(counts["dropped"], 0) << process << " " << channel;
      }
      EXPECT_EQ(counts["undecodable"], 0) << process << " " << channel;
    }
  }
  EXPECT_TRUE(fs::exists(out.string() + "-view/trajectory.png"));
  const std::string map = out.string();
  const Outcome exported =
      shell("$RUMI/rumi export-map '" + map + "' --format ply --images '" + sequence_.string() + "' -o '" + map +
            "-seen' && $RUMI/rumi export-map '" + map + "' --format ply -o '" + map + "-unseen'");
  ASSERT_EQ(exported.exit_code, 0) << exported.output;
  EXPECT_TRUE(read_file(out / "map.ply") == read_file(map + "-seen/map.ply")) << "it has the colours of the images";
  EXPECT_FALSE(read_file(out / "map.ply") == read_file(map + "-unseen/map.ply"));
}

TEST_F(LiveTest, ImagesThatCameTooFastAreToldOf) {
  const fs::path out = work_->path() / "fast";
  const Outcome outcome = shell(up(out, "--speed 20 --set ruminator.rebuild=false"));
  EXPECT_EQ(outcome.exit_code, 3) << outcome.output;
  EXPECT_THAT(outcome.output, ContainsRegex("[0-9]+ of [0-9]+ images were dropped: they came faster"));
  EXPECT_THAT(outcome.output, ContainsRegex("left out +of the [0-9]+ images that came [0-9]+ were dropped"));
}

// Publishes the images of the log at 30 Hz, as another program would. `change` may change each image; it also gets its
// number.
void publish(const std::string& log_file, const std::function<void(int, image_t*)>& change) {
  const Result<std::unique_ptr<LcmBus>> opened = LcmBus::open(kDefaultLcmUrl, {});
  ASSERT_TRUE(opened) << opened.error_text();
  const std::unique_ptr<LcmBus>& bus = *opened;
  LogReader log(log_file);
  for (int i = 0; const std::optional<LogEvent> event = log.next_on(channels::kCamera); ++i) {
    image_t image;
    ASSERT_TRUE(Bus::decode(event->data, &image));
    change(i, &image);
    bus->publish(channels::kCamera, image);
    std::this_thread::sleep_for(std::chrono::milliseconds(33));
  }
}

// Runs a system without an input, calls `images`, and stops the system. Returns its exit code and output.
Outcome up_beside(const fs::path& out, const std::string& flags, const std::function<void()>& images) {
  const std::string said = out.string() + ".log", pid = out.string() + ".pid", code = out.string() + ".code";
  shell("( $RUMI/rumi up '" RUMI_CONFIG "' " + flags + " --set up.viewer=false --set map_server.database='" +
        out.string() + "-live.db' --set ruminator.spool='" + out.string() + "-spool' -o '" + out.string() + "' > '" +
        said + "' 2>&1 & echo $! > '" + pid + "'; wait $!; echo $? > '" + code + "' ) > /dev/null 2>&1 & sleep 3");
  images();
  shell("kill -INT $(cat '" + pid + "'); while [ ! -s '" + code + "' ]; do sleep .1; done");
  return {std::stoi(read_file(code)), read_file(said)};
}

TEST_F(LiveTest, ImagesThatAreRefusedAreSaidLastAndTimesThatStandBeginNothing) {
  const fs::path log = work_->path() / "some.lcm";
  ASSERT_EQ(shell("$RUMI/rumi export '" + sequence_.string() + "' --duration 4 -o '" + log.string() + "'").exit_code,
            0);
  const Outcome outcome = up_beside(work_->path() / "other_size", "--set ruminator.rebuild=false", [&] {
    publish(log, [](int i, image_t* image) { image->width /= i < 60 ? 1 : 2; });
  });
  EXPECT_EQ(outcome.exit_code, 3) << outcome.output;
  EXPECT_THAT(outcome.output,
              ContainsRegex("rumi up: front_tracker: 60 of 120 images refused: not of the calibration's size"));
  const fs::path standing = work_->path() / "standing";
  const Outcome without = up_beside(standing, "", [&] { publish(log, [](int, image_t* image) { image->utime = 0; }); });
  EXPECT_EQ(without.exit_code, 3) << without.output;
  EXPECT_THAT(without.output, HasSubstr("the times of the images stand (0): utime must be microseconds since 1970"));
  EXPECT_THAT(without.output, HasSubstr("rumi up: front_tracker: 120 of 120 images refused: without a time"));
  EXPECT_TRUE(fs::is_empty(standing.string() + "-spool/failed"));
}

TEST_F(LiveTest, ACameraDriverThatSomebodyEndsIsNoEndOfTheRecording) {
  const fs::path out = work_->path() / "ended";
  const Outcome outcome = up_and(out, "", "pkill -TERM -P $up -x camera_driver");
  EXPECT_EQ(outcome.exit_code, 3) << outcome.output;
  EXPECT_THAT(outcome.output, ContainsRegex("rumi up: camera_driver: .* ended after [0-9]+ of 240 images"));
  EXPECT_TRUE(fs::exists(out / "trajectory.txt"));
}

TEST_F(LiveTest, ADamagedMapIsToldInTheWordsOfMapServerAndNothingBegins) {
  const fs::path out = work_->path() / "damaged";
  testing::write_file(out.string() + "-live.db", std::string(5000, 'x'));
  const Outcome outcome = shell(up(out, ""));
  EXPECT_EQ(outcome.exit_code, 1) << outcome.output;
  EXPECT_THAT(outcome.output, HasSubstr("-live.db is not an SQLite database; give another file or move it away"));
  EXPECT_THAT(outcome.output, ::testing::Not(HasSubstr("a new one")));
  EXPECT_THAT(outcome.output, ::testing::Not(HasSubstr("camera_driver|")));
}

TEST_F(LiveTest, ImagesFromElsewhereGetTheCalibrationOfTheCommandLine) {
  const fs::path out = work_->path() / "elsewhere", log = work_->path() / "images.lcm";
  ASSERT_EQ(shell("$RUMI/rumi export '" + sequence_.string() + "' -o '" + log.string() + "'").exit_code, 0);
  const Outcome outcome =
      up_beside(out, "--camera '" + (sequence_ / "calibration.yaml").string() + "' --set ruminator.rebuild=false", [&] {
        publish(log, [](int, image_t* image) {
          image->nmetadata = 0;
          image->metadata.clear();
        });
      });
  ASSERT_TRUE(fs::exists(out / "trajectory.txt")) << outcome.output;
  expect_tracked(out);
}

TEST_F(LiveTest, ADeadMapServerIsStartedAgainAndNothingIsLost) {
  const fs::path out = work_->path() / "killed";
  const Outcome outcome = up_and(out, "", "kill -9 $(cat '" + out.string() + "-live.db.lock')");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_THAT(outcome.output, HasSubstr("map_server was ended by signal 9"));
  const auto figures = evaluate(out, sequence_ / "groundtruth.txt");
  EXPECT_GE(figures["tracked_frames"], 216) << "poses travel with the submaps, which are sent until they are stored";
}

TEST_F(LiveTest, ASecondSystemOnTheBusIsRefusedAndTheFirstGoesOn) {
  const fs::path first = work_->path() / "first", second = work_->path() / "second";
  const Outcome outcome =
      up_and(first, "",
             up(second, "") + "; echo \"second: $?\"; $RUMI/map_server --set map_server.database='" +
                 (work_->path() / "third.db").string() + "'; echo \"third: $?\"");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_THAT(outcome.output, HasSubstr("another system is on this bus"));
  EXPECT_THAT(outcome.output, HasSubstr("--set up.channel_prefix=NAME"));
  EXPECT_THAT(outcome.output, HasSubstr("second: 1"));
  EXPECT_THAT(outcome.output, HasSubstr("another map_server is on this bus"));
  EXPECT_THAT(outcome.output, HasSubstr("third: 2"));
  EXPECT_FALSE(fs::exists(second));
  expect_tracked(first);
}

TEST_F(LiveTest, AKilledRuminatorGoesOnWithItsWindowWhichIsWaitedFor) {
  const TemporaryFolder work;
  const fs::path sequence = render(work, "--seconds 6 --hard blur --at 3 --for 1.5");
  const fs::path out = work.path() / "out", log = work.path() / "log", spool = work.path() / "spool";
  const Outcome outcome =
      shell("$RUMI/rumi up '" RUMI_CONFIG "' '" + sequence.string() + "' --snapshot '" + out.string() +
            "' --set up.viewer=false --set map_server.database='" + (work.path() / "live.db").string() +
            "' --set ruminator.spool='" + spool.string() + "' > '" + log.string() +
            "' 2>&1 & up=$!; while kill -0 $up 2>/dev/null && [ ! -e '" + spool.string() +
            "'/*-1.work ]; do sleep 0.1; done; pkill -9 -P $up -x ruminator; wait $up");
  const std::string text = read_file(log);
  ASSERT_EQ(outcome.exit_code, 0) << text;
  EXPECT_THAT(text, HasSubstr("ruminator was ended by signal 9"));
  EXPECT_THAT(text, HasSubstr("left in the spool"));
  EXPECT_THAT(text, HasSubstr("map_server has it as submap -1"));
  EXPECT_TRUE(fs::exists(out / "submaps/b001.txt"));
  for (const auto& entry : fs::directory_iterator(spool))
    EXPECT_TRUE(entry.is_directory() || entry.path().extension() == ".id") << entry.path();
}

// The map is of the first 5 s of the recording; the run begins at 3 s.
TEST_F(LiveTest, LocalizesInAMapThatStaysAsItIs) {
  const fs::path first = work_->path() / "to_localize_in", out = work_->path() / "localized", map = first / "map.db";
  const Outcome mapping =
      shell("$RUMI/rumi replay -q '" + sequence_.string() + "' -o '" + first.string() + "' --duration 5");
  ASSERT_EQ(mapping.exit_code, 0) << mapping.output;
  const std::string bytes = read_file(map);
  const Outcome localizing =
      shell(up(out, "--start 3 --set map_server.localize_only=true --set map_server.database='" + map.string() + "'"));
  ASSERT_EQ(localizing.exit_code, 0) << localizing.output;
  EXPECT_TRUE(read_file(map) == bytes);
  const auto figures = evaluate(out, sequence_ / "groundtruth.txt");
  EXPECT_EQ(figures["frames"], 150) << "those of this run";
  EXPECT_GE(figures["tracked_frames"], 135);
  EXPECT_THAT(localizing.output, HasSubstr("stays as it is"));
  EXPECT_THAT(localizing.output, HasSubstr("of 150 frames of this run in"));
  EXPECT_GE(figures["true_rate"], 0.9);
  EXPECT_LE(figures["ate_rmse_m"], 0.05);
}

// The first run takes the first 4 s of the recording. There is no CONFIG, and all channels have a prefix.
TEST_F(LiveTest, TheNextRunGoesOnWithTheMapAndTellsOfItsOwnFrames) {
  const fs::path folder = work_->path() / "next";
  fs::create_directories(folder);
  const std::string begin = "cd '" + folder.string() + "' && $RUMI/rumi up '" + sequence_.string() +
                            "' --channel-prefix A_ --set up.viewer=false ";
  const Outcome first = shell(begin + "-o first --duration 4");
  ASSERT_EQ(first.exit_code, 0) << first.output;
  EXPECT_THAT(first.output, HasSubstr("map: map.db, a new one"));
  const Outcome second = shell(begin + "-o second --start 4");
  ASSERT_EQ(second.exit_code, 0) << second.output;
  EXPECT_THAT(second.output, HasSubstr("map: map.db goes on, 120 frames of an earlier session; --fresh begins anew"));
  EXPECT_THAT(second.output, HasSubstr("localized: "));
  const auto counts = read_json_file(folder / "second/run.json")["counts"];
  EXPECT_EQ(counts["frames"], 120);
  EXPECT_EQ(counts["earlier_frames"], 120);
  const Outcome fresh = shell(begin + "-o third --fresh --duration 2");
  ASSERT_EQ(fresh.exit_code, 0) << fresh.output;
  EXPECT_THAT(fresh.output, HasSubstr("map: map.db, a new one; that of before is map-"));
  EXPECT_FALSE(read_json_file(folder / "third/run.json")["counts"].contains("earlier_frames"));
  const Outcome wrong = shell(begin + "--fresh --set map_server.localize_only=true");
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.output, HasSubstr("--fresh: there would be no map to localize in"));
}

TEST_F(LiveTest, EndsCleanlyWhenAskedTo) {
  const fs::path out = work_->path() / "interrupted";
  const Outcome outcome = up_and(out, "--loop", "kill -INT $up");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_THAT(outcome.output, ::testing::Not(HasSubstr("killed")));
  EXPECT_TRUE(fs::exists(out / "trajectory.txt"));
  EXPECT_FALSE(fs::exists(out.string() + "-live.db.lock")) << "map_server did not end by itself";
}

TEST_F(LiveTest, AClosedTerminalWhichIsToldTwiceEndsItCleanly) {
  const fs::path out = work_->path() / "closed";
  const Outcome outcome = up_and(out, "--loop", "kill -HUP $up; sleep 0.2; kill -HUP $up");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_TRUE(fs::exists(out / "trajectory.txt"));
}

TEST_F(LiveTest, ASnapshotOfNobodySaysSo) {
  const Outcome outcome = shell("$RUMI/rumi snapshot --timeout 1 -o '" + (work_->path() / "nobody").string() + "'");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.output, HasSubstr("no map_server answered within 1 s"));
}

}  // namespace
}  // namespace rumi::tool
