// SPDX-License-Identifier: BSD-3-Clause
// Tests what `rumi evaluate` says about a truth that cannot be used, and its exit code.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <fstream>
#include <functional>

#include "rumi/commands/command_frame.h"
#include "rumi/commands/commands.h"
#include "tests/support/temporary_folder.h"

namespace rumi::tool {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

struct Said {
  int code = 0;
  std::string out, err;
};

class EvaluateCommandTest : public ::testing::Test {
 protected:
  EvaluateCommandTest() {
    std::filesystem::create_directories(folder_.path() / "submaps");
    write("frames.csv", frames());
    write("trajectory.txt", walk(0, 40, 1.4e9));
  }
  void write(const std::string& name, const std::string& text) { std::ofstream(folder_.path() / name) << text; }
  static std::string frames() {
    std::string text = "utime,state,submap,in_map\n";
    for (int i = 0; i < 40; ++i) text += fmt::format("{},TRACKING,1,1\n", 1'400'000'000'000'000 + 100'000 * int64_t{i});
    return text;
  }
  static std::string walk(int from, int to, double start_s) {
    std::string text;
    for (int i = from; i < to; ++i)
      text += fmt::format("{:.6f} {:.6f} {:.6f} 0 0 0 0 1\n", start_s + 0.1 * i, 0.1 * i, 0.01 * i * i);
    return text;
  }
  Said evaluate(const std::string& truth, std::vector<std::string> flags = {}) {
    write("truth.txt", truth);
    flags.insert(flags.begin(), {"--groundtruth", (folder_.path() / "truth.txt").string()});
    return evaluate_with(flags);
  }
  Said evaluate_with(const std::vector<std::string>& flags) {
    std::vector<std::string> words = {"rumi", "evaluate", folder_.path().string()};
    words.insert(words.end(), flags.begin(), flags.end());
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    CommandLine app("test", "rumi");
    std::function<int()> chosen;
    add_evaluate_command(app, &chosen);
    EXPECT_EQ(app.parse(static_cast<int>(argv.size()), argv.data()).error, "");
    ::testing::internal::CaptureStdout();
    ::testing::internal::CaptureStderr();
    Said said;
    said.code = run_command("evaluate", chosen);
    std::fflush(stdout);
    said.out = ::testing::internal::GetCapturedStdout();
    said.err = ::testing::internal::GetCapturedStderr();
    return said;
  }
  testing::TemporaryFolder folder_;
};

TEST_F(EvaluateCommandTest, TellsOfPosesWithTheTimeOfOthers) {
  write("trajectory.txt", walk(0, 40, 1.4e9) + walk(10, 20, 1.4e9));
  const Said said = evaluate(walk(0, 40, 1.4e9));
  EXPECT_EQ(said.code, 0) << said.err;
  EXPECT_THAT(said.out, HasSubstr("trajectory.txt: 10 lines are not counted"));
}

TEST_F(EvaluateCommandTest, MeasuresARun) {
  const Said said = evaluate(walk(0, 40, 1.4e9));
  EXPECT_EQ(said.code, 0) << said.err;
  EXPECT_THAT(said.out, HasSubstr("ATE RMSE after Sim(3) alignment             0.0000 m"));
  EXPECT_THAT(said.err, IsEmpty());
}

TEST_F(EvaluateCommandTest, WithoutATruthTakesTheOneBesideTheRecording) {
  const std::string recording = folder_ / "recording";
  write("run.json", fmt::format(R"({{"input": "{}", "options": {{"camera_driver": {{"rate": 10}}}}}})", recording));
  EXPECT_THAT(evaluate_with({}).err, AllOf(HasSubstr("recording is no longer there"), HasSubstr("--groundtruth FILE")));
  std::filesystem::create_directory(recording);
  EXPECT_THAT(evaluate_with({}).err, AllOf(HasSubstr("there is no truth beside"), HasSubstr("--groundtruth FILE")));
  write("recording/groundtruth.txt", walk(0, 40, 1.4e9));
  const Said said = evaluate_with({});
  EXPECT_EQ(said.code, 0) << said.err;
  EXPECT_THAT(said.out, AllOf(HasSubstr(recording + "/groundtruth.txt"),
                              HasSubstr("ATE RMSE after Sim(3) alignment             0.0000 m")));
}

TEST_F(EvaluateCommandTest, ATruthThatCountsImagesHasTheRateAtWhichTheyWerePlayed) {
  std::string frames = "utime,state,submap,in_map\n", truth;
  for (int i = 0; i < 40; ++i) frames += fmt::format("{},TRACKING,1,1\n", 100'000 * int64_t{i});
  for (int i = 0; i < 40; ++i) truth += fmt::format("{} {} {} 0 0 0 0 1\n", i, 0.1 * i, -0.01 * i * i);
  write("frames.csv", frames);
  write("trajectory.txt", walk(0, 40, 0));
  std::filesystem::create_directory(folder_.path() / "recording");
  write("recording/traj0.gt.freiburg", truth);
  write("run.json",
        fmt::format(R"({{"input": "{}", "options": {{"camera_driver": {{"rate": 10}}}}}})", folder_ / "recording"));
  const Said said = evaluate_with({});
  EXPECT_EQ(said.code, 0) << said.err;
  EXPECT_THAT(said.out, AllOf(HasSubstr("40 of 40, 40 with a truth"),
                              HasSubstr("ATE RMSE after Sim(3) alignment             0.0000 m")));
}

TEST_F(EvaluateCommandTest, OfARunThatNamesNoRecordingAsksForTheTruth) {
  EXPECT_THAT(evaluate_with({}).err, HasSubstr("names no recording (input) beside which a truth could be"));
}

TEST_F(EvaluateCommandTest, DoubtsATruthInMillimetres) {
  std::string metres, millimetres;
  for (int i = 0; i < 40; ++i) {
    metres += fmt::format("{:.6f} {} {} 0\n", 1.4e9 + 0.1 * i, 0.1 * i, 0.01 * i * i);
    millimetres += fmt::format("{:.6f} {} {} 0\n", 1.4e9 + 0.1 * i, 100 * i, 10 * i * i);
  }
  EXPECT_EQ(evaluate(metres).out.find("millimetres"), std::string::npos);
  EXPECT_THAT(evaluate(millimetres).out, HasSubstr("if it is in millimetres, divide it by 1000"));
}

TEST_F(EvaluateCommandTest, ATruthThatStandsStillMeasuresNothing) {
  std::string truth;
  for (int i = 0; i < 40; ++i) truth += fmt::format("{:.6f} -0.7 0.1 0.4 0 0 0 1\n", 1.4e9 + 0.1 * i);
  const Said said = evaluate(truth, {"--json"});
  EXPECT_EQ(said.code, 1);
  EXPECT_THAT(said.err, HasSubstr("one and the same place"));
  EXPECT_THAT(said.out, AllOf(HasSubstr("\"true_rate\": null"), HasSubstr("\"ate_rmse_m\": null")));
}

TEST_F(EvaluateCommandTest, ATruthOfAFewCentimetresHasNoTrueRate) {
  std::string truth;
  for (int i = 0; i < 40; ++i) truth += fmt::format("{:.6f} {:.6f} 0 0 0 0 0 1\n", 1.4e9 + 0.1 * i, 0.001 * i);
  const Said said = evaluate(truth);
  EXPECT_THAT(said.out, AllOf(HasSubstr("all of the truth lies within 0.1 m"), HasSubstr("--true-distance")));
  EXPECT_EQ(evaluate(truth, {"--true-distance", "0.01"}).out.find("lies within"), std::string::npos);
}

TEST_F(EvaluateCommandTest, LinesThatCannotBeAreLeftOutAndJumpsAreTold) {
  std::string truth = walk(0, 40, 1.4e9);
  const Said huge = evaluate(walk(0, 20, 1.4e9) + "1400000002.0 1e308 1e308 0 0 0 0 1\n" + walk(21, 40, 1.4e9));
  EXPECT_EQ(huge.code, 0) << huge.err;
  EXPECT_THAT(huge.out,
              AllOf(HasSubstr("1 of 40 lines are no poses (first: line 21, 1e+308, 1e+308, 0 is no position)"),
                    HasSubstr("ATE RMSE after Sim(3) alignment             0.0000 m")));
  const Said jump = evaluate(walk(0, 20, 1.4e9) + "1400000002.0 1e6 0 0 0 0 0 1\n" + walk(21, 40, 1.4e9));
  EXPECT_THAT(jump.out, HasSubstr("1 of its positions is more than 100 usual steps away"));
  EXPECT_THAT(jump.out, HasSubstr("first: line 21"));
  EXPECT_EQ(evaluate(truth).out.find("usual steps"), std::string::npos);
  write("trajectory.txt", walk(0, 39, 1.4e9) + "1400000003.9 1e200 0 0 0 0 0 1\n");
  EXPECT_THAT(evaluate(truth).out, HasSubstr("trajectory.txt: 1 lines are not counted"));
}

TEST_F(EvaluateCommandTest, WithoutItsPictureTheNumbersAreWorthAsMuch) {
  std::filesystem::create_directory(folder_.path() / "evaluation.png");
  const Said said = evaluate(walk(0, 40, 1.4e9));
  EXPECT_EQ(said.code, 0);
  EXPECT_THAT(said.out, HasSubstr("ATE RMSE after Sim(3) alignment             0.0000 m"));
  EXPECT_THAT(said.err, HasSubstr("evaluation.png: cannot be written (Is a directory): there is no picture"));
}

TEST_F(EvaluateCommandTest, RefusesAnotherClockWithBothSpans) {
  const Said said = evaluate(walk(0, 40, 12.5));
  EXPECT_EQ(said.code, 1);
  EXPECT_THAT(said.err,
              AllOf(HasSubstr("0 of 40 images have a truth"), HasSubstr("from 1400000000.000 to 1400000003.900 s"),
                    HasSubstr("from 12.500 to 16.400 s")));
  EXPECT_THAT(said.out, IsEmpty());
}

TEST_F(EvaluateCommandTest, RefusesATruthOfTwoImages) {
  const Said said = evaluate(walk(38, 60, 1.4e9));
  EXPECT_EQ(said.code, 1);
  EXPECT_THAT(said.err, HasSubstr("2 of 40 images have a truth"));
}

TEST_F(EvaluateCommandTest, TellsThatNothingWasTrackedAndGivesTheFigures) {
  write("trajectory.txt", "");
  const Said said = evaluate(walk(0, 40, 1.4e9), {"--json"});
  EXPECT_EQ(said.code, 1);
  EXPECT_THAT(said.err, AllOf(HasSubstr("nothing could be computed"), HasSubstr("0 of 0 poses")));
  EXPECT_THAT(said.out, AllOf(HasSubstr("\"true_rate\": 0.0"), HasSubstr("\"ate_rmse_m\": null")));
}

TEST_F(EvaluateCommandTest, TellsWhichLinesAreNoPosesAndCountsOnlyFramesWithATruth) {
  std::string truth = walk(0, 40, 1.4e9);
  for (int i = 0; i < 20; ++i) truth.replace(truth.find("0 0 0 0 1\n"), 10, "0 nan 0 0 1\n");
  const Said said = evaluate(truth);
  EXPECT_EQ(said.code, 0) << said.err;
  EXPECT_THAT(said.out, AllOf(HasSubstr("20 of 40 lines are no poses (first: line 1, nan)"),
                              HasSubstr("true_rate (near the truth / with a truth)   1.0000")));
}

TEST_F(EvaluateCommandTest, TakesPositionsWithoutRotations) {
  std::string truth;
  for (int i = 0; i < 40; ++i) truth += fmt::format("{:.6f} {:.6f} {:.6f} 0\n", 1.4e9 + 0.1 * i, 0.1 * i, 0.01 * i * i);
  const Said said = evaluate(truth);
  EXPECT_EQ(said.code, 0) << said.err;
  EXPECT_THAT(said.out, AllOf(HasSubstr("needs rotations, which are not in this file"), HasSubstr("0.0000 m")));
}

}  // namespace
}  // namespace rumi::tool
