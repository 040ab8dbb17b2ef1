// SPDX-License-Identifier: BSD-3-Clause
#include "base/command_line/command_line.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cstdio>
#include <cstdlib>

#include "base/files/whole_file.h"
#include "tests/support/temporary_folder.h"

namespace rumi {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class CommandLineTest : public ::testing::Test {
 protected:
  CommandLineTest() {
    CommandLine* replay = app_.add_command("replay", "plays");
    replay->add_option("INPUT", input_, "")->required();
    replay->add_option("-o,--output", output_, "")->required();
    replay->add_option("--every", every_, "");
  }
  std::string error(std::vector<std::string> words) {
    words.insert(words.begin(), "rumi");
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    return app_.parse(static_cast<int>(argv.size()), argv.data()).error;
  }
  CommandLine app_{"a program", "rumi"};
  std::string input_, output_;
  int every_ = 1;
};

TEST(CommandLineOfAProgram, AFileThatGrowsTooLargeIsAnErrorAndNotTheEnd) {
  const testing::TemporaryFolder folder;
  const auto write_too_much = [&folder] {
    const CommandLine app("a program", "rumi");
    const rlimit limit{100, 100};
    setrlimit(RLIMIT_FSIZE, &limit);
    WholeFile file(folder / "too_large");
    file.write(std::string(1000, 'x'));
    std::fputs(file.commit().error_text().c_str(), stderr);
    std::_Exit(7);
  };
  EXPECT_EXIT(write_too_much(), ::testing::ExitedWithCode(7), "too_large: File too large");
}

TEST_F(CommandLineTest, AMisspeltFlagHasTheNearOneBesideIt) {
  EXPECT_EQ(error({"replay", "in", "-o", "out", "--evry", "2"}),
            "--evry: there is no such flag; did you mean --every?");
  EXPECT_EQ(error({"replay", "in", "-o", "out", "--evry=2"}), "--evry: there is no such flag; did you mean --every?");
  EXPECT_EQ(error({"replay", "in", "-o", "out", "-every", "2"}), "-every: did you mean --every?");
}

TEST_F(CommandLineTest, WhatIsMissingBecauseOfItIsNotWhatIsTold) {
  EXPECT_EQ(error({"replay", "in", "--out", "out"}), "--out: there is no such flag; did you mean --output?");
}

TEST_F(CommandLineTest, AMisspeltCommandHasTheNearOneBesideIt) {
  EXPECT_EQ(error({"relay", "in"}), "relay: there is no such command; did you mean replay?");
  EXPECT_EQ(error({"frobnicate"}), "frobnicate: there is no such command");
}

TEST_F(CommandLineTest, AValueThatIsNoneIsToldWithItsFlag) {
  EXPECT_EQ(error({"replay", "in", "-o", "out", "--every", "often"}), "--every = often: expected a number");
  EXPECT_EQ(error({"replay", "in", "-o", "out", "--every"}), "--every: its value is missing");
  EXPECT_EQ(error({}), "a command is missing");
}

TEST_F(CommandLineTest, ARangeIsToldWithTheValue) {
  CommandLine app("a program", "rumi");
  double rate = 0;
  std::string kind;
  int count = 0;
  app.add_option("--rate", rate, "")->not_negative();
  app.add_option("--speed", rate, "")->positive();
  app.add_option("--count", count, "")->in_range(1, 9);
  app.add_option("--kind", kind, "")->one_of({"a", "b"});
  const auto error_of = [&app](std::vector<std::string> words) {
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    return app.parse(static_cast<int>(argv.size()), argv.data()).error;
  };
  EXPECT_EQ(error_of({"rumi", "--rate", "0", "--speed", "0.5", "--count", "9", "--kind", "b"}), "");
  EXPECT_EQ(error_of({"rumi", "--rate", "-1"}), "--rate: '-1' must be a number that is not negative");
  EXPECT_EQ(error_of({"rumi", "--rate", "nan"}), "--rate: 'nan' must be a number that is not negative");
  EXPECT_EQ(error_of({"rumi", "--speed", "0"}), "--speed: '0' must be a number above 0");
  EXPECT_EQ(error_of({"rumi", "--count", "10"}), "--count: '10' must be a whole number from 1 to 9");
  EXPECT_EQ(error_of({"rumi", "--kind", "c"}), "--kind: 'c' must be one of a, b");
}

TEST_F(CommandLineTest, WhatIsSpeltRightIsNotBlamed) {
  EXPECT_THAT(error({"replay", "in"}), HasSubstr("--output is required"));
  EXPECT_THAT(error({"replay", "in", "-o", "out", "--every", "often"}), Not(HasSubstr("did you mean")));
  EXPECT_EQ(error({"replay", "in", "-oout", "--every", "-2"}), "");
}

}  // namespace
}  // namespace rumi
