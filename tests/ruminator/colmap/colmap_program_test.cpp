// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/colmap/colmap_program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/ruminator/colmap/fake_colmap.h"
#include "tests/support/temporary_folder.h"

namespace rumi::ruminator {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

const std::atomic<bool> kNever = false;
constexpr const char* kHelp = "cat \"$(dirname \"$0\")/help\"";

class ColmapProgramTest : public ::testing::Test {
 protected:
  std::string script(const std::string& body) const {
    folder_.write("help", testing::help_text(testing::kDebian12));
    const std::string file =
        folder_.write("colmap", "#!/bin/sh\necho asked >> '" + folder_ / "asked" + "'\n" + body + "\n");
    std::filesystem::permissions(file, std::filesystem::perms::owner_all);
    return file;
  }
  std::string asked() const { return testing::read_file(folder_ / "asked"); }
  TemporaryFolder folder_;
};

TEST_F(ColmapProgramTest, IsAskedOnce) {
  ColmapProgram program(script(kHelp));
  EXPECT_TRUE(program.ask(0, kNever).ok());
  EXPECT_TRUE(program.ask(0, kNever).ok());
  EXPECT_EQ(asked(), "asked\n");
  EXPECT_EQ(program.version(), "3.8");
  EXPECT_EQ(program.problem(), "");
}

TEST_F(ColmapProgramTest, AHelpTextOfAnyLengthIsUnderstood) {
  const std::string help = kHelp;
  ColmapProgram program(script(help + "; yes '  --Mapper.one_more_option arg (=0)' | head -n 20000"));
  EXPECT_TRUE(program.ask(0, kNever).ok());
  EXPECT_TRUE(program.options().contains("database_path"));
}

TEST_F(ColmapProgramTest, WhatItLeavesWhenAskedIsRemoved) {
  ColmapProgram program(script(
      "echo log > \"$TMPDIR/colmap.INFO\" && echo \"$TMPDIR\" > \"$(dirname \"$0\")/where\"\n" + std::string(kHelp)));
  EXPECT_TRUE(program.ask(0, kNever).ok());
  std::string where = testing::read_file(folder_ / "where");
  where.pop_back();  // removes the newline
  EXPECT_THAT(where, HasSubstr("/rumi-colmap-"));
  EXPECT_FALSE(std::filesystem::exists(where));
}

TEST_F(ColmapProgramTest, OneThatIsNotThereIsTold) {
  ColmapProgram program("rumi-no-such-colmap");
  EXPECT_FALSE(program.ask(0, kNever).ok());
  EXPECT_THAT(program.problem(), AllOf(HasSubstr("COLMAP: rumi-no-such-colmap: not found in PATH"),
                                       HasSubstr("windows are rebuilt without it")));
}

TEST_F(ColmapProgramTest, ABrokenOneIsToldAndUsedOnceItIsMended) {
  ColmapProgram program(script("echo 'colmap: error while loading shared libraries: libceres.so.2' >&2; exit 127"));
  EXPECT_FALSE(program.ask(0, kNever).ok());
  EXPECT_THAT(program.problem(), HasSubstr("ended with exit code 127: colmap: error while loading shared libraries"));
  script(kHelp);
  EXPECT_TRUE(program.ask(0, kNever).ok());
  EXPECT_EQ(program.problem(), "");
}

TEST_F(ColmapProgramTest, ABrokenOneIsToldOnceWhateverElseItSays) {
  ColmapProgram program(script("echo \"process $$ aborted\" >&2; exit 1"));
  ::testing::internal::CaptureStdout();  // where lines go before the log is started
  EXPECT_FALSE(program.ask(0, kNever).ok());
  EXPECT_FALSE(program.ask(0, kNever).ok());
  const std::string printed = ::testing::internal::GetCapturedStdout();
  EXPECT_NE(printed.find("COLMAP: "), std::string::npos);
  EXPECT_EQ(printed.find("COLMAP: "), printed.rfind("COLMAP: ")) << printed;
}

TEST_F(ColmapProgramTest, OneThatOpensAWindowIsToldAndNotAskedAgain) {
  ColmapProgram program(script("exec sleep 100"), /*idle_limit_s=*/0.1);
  EXPECT_FALSE(program.ask(0, kNever).ok());
  EXPECT_TRUE(program.is_given_up());
  EXPECT_THAT(program.problem(), HasSubstr("does it open a window"));
  EXPECT_FALSE(program.ask(0, kNever).ok());
  EXPECT_EQ(asked(), "asked\n");
}

TEST_F(ColmapProgramTest, AQuestionUnderWayIsWaitedFor) {
  ColmapProgram program(script(kHelp));
  program.begin_asking();
  EXPECT_TRUE(program.ask(0, kNever).ok());
  EXPECT_EQ(asked(), "asked\n");
}

TEST_F(ColmapProgramTest, AQuestionUnderWayEndsWithIt) {
  ColmapProgram program(script("exec sleep 100"));
  program.begin_asking();
}

TEST_F(ColmapProgramTest, AComplaintOfAGpuIsKnown) {
  EXPECT_TRUE(tells_of_gpu("F0501 cuda.cc:48] Check failed: cudaGetDeviceCount(&n) == cudaSuccess: CUDA driver"));
  EXPECT_FALSE(tells_of_gpu("COLMAP 3.8 (without CUDA)\nERROR: failed to create sparse model"));
}

}  // namespace
}  // namespace rumi::ruminator
