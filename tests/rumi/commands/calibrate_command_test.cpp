// SPDX-License-Identifier: BSD-3-Clause
// Runs `rumi calibrate` and `rumi draw-board` as a user does, also live over real LCM multicast. It needs a network
// namespace (tests/run_in_netns.sh).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/rumi/commands/end_to_end.h"

namespace rumi::tool {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

class CalibrateCommand : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    work_ = new TemporaryFolder;
    const Outcome outcome = shell("$RUMI/../tests/render_boards '" + images() + "' pinhole 480 360 40");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
    fs::rename(images() + "/truth.yaml", file("truth.yaml"));
  }
  static void TearDownTestSuite() { delete work_; }
  static std::string file(const std::string& name) { return (work_->path() / name).string(); }
  static std::string images() { return file("images"); }
  static Outcome calibrate(const std::string& arguments) { return shell("$RUMI/rumi calibrate " + arguments); }
  static TemporaryFolder* work_;
};
TemporaryFolder* CalibrateCommand::work_ = nullptr;

TEST_F(CalibrateCommand, WritesAFileAndSaysHowGoodItIs) {
  const Outcome outcome = calibrate(images() + " -o " + file("a.yaml"));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_THAT(outcome.output, AllOf(HasSubstr("views taken"), HasSubstr("fx"), HasSubstr("reprojection error: 0.")));
  EXPECT_THAT(read_file(file("a.yaml")), HasSubstr("model: pinhole\nfx: 39"));
  // Other commands accept the calibration.
  const Outcome replayed =
      shell("$RUMI/rumi export " + images() + " --rate 5 --camera " + file("a.yaml") + " -o " + file("boards.lcm"));
  EXPECT_EQ(replayed.exit_code, 0) << replayed.output;
  // A log of the same images gives a calibration, too.
  const Outcome logged = calibrate(file("boards.lcm") + " -o " + file("b.yaml") + " --picture " + file("b.png"));
  EXPECT_EQ(logged.exit_code, 0) << logged.output;
  EXPECT_THAT(read_file(file("b.png")), HasSubstr("PNG"));
}

TEST_F(CalibrateCommand, APictureShowsWhatWasSeenAlsoIfItIsNotEnough) {
  const Outcome outcome =
      calibrate(images() + " -o " + file("none.yaml") + " --every 10 --picture " + file("refused.png"));
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(read_file(file("refused.png")), HasSubstr("PNG"));
  const Outcome nowhere = calibrate(images() + " -o " + file("none.yaml") + " --picture " + file("no/where.png"));
  EXPECT_EQ(nowhere.exit_code, 1);
  EXPECT_THAT(nowhere.output, HasSubstr("there is no folder"));
}

TEST_F(CalibrateCommand, ACameraIsToBePublishedByCameraDriver) {
  for (const char* camera : {"/dev/video0", "camera:HD"}) {
    const Outcome outcome = calibrate(std::string(camera) + " -o " + file("none.yaml"));
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.output,
                AllOf(HasSubstr(camera), HasSubstr("start `rumi camera_driver "), HasSubstr("without SOURCE")));
  }
}

TEST_F(CalibrateCommand, WhatCannotBeEndsWithAReasonAndNoFile) {
  const std::string out = " -o " + file("none.yaml");
  Outcome outcome = calibrate(images() + out + " --board chess:3x3");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.output, HasSubstr("the kind is 'chess'"));
  outcome = calibrate(images() + " -o " + file("no/where.yaml"));
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.output, HasSubstr("there is no folder"));
  outcome = calibrate(images() + out + " --every 10");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.output, AllOf(HasSubstr("different views of the board are too few"), HasSubstr("missing: ")));
  outcome = calibrate(images() + out + " --max-rms 0.01");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.output, AllOf(HasSubstr("more than 0.01 px (--max-rms)"), HasSubstr("--force")));
  EXPECT_FALSE(fs::exists(file("none.yaml")));
  outcome = calibrate(images() + out + " --max-rms 0.01 --force");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_THAT(read_file(file("none.yaml")), HasSubstr("# DOUBTFUL: the reprojection error is"));
}

TEST_F(CalibrateCommand, LiveItEndsWhenThereIsEnough) {
  const Outcome outcome = shell("$RUMI/camera_driver " + images() + " --loop --rate 5 --camera " + file("truth.yaml") +
                                " & driver=$!; $RUMI/rumi calibrate -o " + file("live.yaml") +
                                "; code=$?; kill $driver; wait $driver; exit $code");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_THAT(outcome.output, HasSubstr("reprojection error: 0."));
  EXPECT_THAT(read_file(file("live.yaml")), HasSubstr("fx: 39"));
}

TEST_F(CalibrateCommand, LiveCtrlCEndsIt) {
  const Outcome outcome = shell(
      "$RUMI/rumi calibrate -o " + file("nothing.yaml") + " >" + file("log") +
      " 2>&1 & calibrate=$!; while kill -0 $calibrate && ! grep -q 'no image' " + file("log") +
      "; do sleep 0.1; done; kill -INT $calibrate; wait $calibrate; code=$?; cat " + file("log") + "; exit $code");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.output, AllOf(HasSubstr("no image yet on CAMERA"), HasSubstr("CAMERA: no image came")));
}

TEST_F(CalibrateCommand, DrawsBoards) {
  EXPECT_EQ(shell("$RUMI/rumi draw-board -o " + file("board.pdf")).exit_code, 0);
  EXPECT_THAT(read_file(file("board.pdf")), HasSubstr("%PDF"));
  const Outcome outcome = shell("$RUMI/rumi draw-board --board chessboard:20x20:26 -o " + file("large.png"));
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.output, HasSubstr("does not fit on a4"));
}

}  // namespace
}  // namespace rumi::tool
