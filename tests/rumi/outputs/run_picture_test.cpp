// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/outputs/run_picture.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "tests/support/temporary_folder.h"

namespace rumi::tool {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class RunPicture : public ::testing::Test {
 protected:
  // Draws with a program that runs this script. Returns the error.
  std::string draw(const std::string& script) {
    const std::string program = folder_ / "program";
    std::ofstream(program) << "#!/bin/sh\n" << script << "\n";
    fs::permissions(program, fs::perms::owner_all);
    return draw_run_picture(folder_.path().string(), program).error_text();
  }
  const testing::TemporaryFolder folder_;
};

TEST_F(RunPicture, IsDrawnByAProgramOfItsOwn) {
  EXPECT_EQ(draw("test \"$1 $2\" = \"view $(dirname $0)/map.db\" && echo drawn >\"$4\""), "");
  EXPECT_TRUE(fs::exists(folder_ / "trajectory.png"));
}

TEST_F(RunPicture, WhyThereIsNoneIsOneSentence) {
  std::ofstream(folder_ / "trajectory.png") << "of an earlier run";
  EXPECT_THAT(draw("echo noise; echo 'rumi view: no OpenGL: it is not here' >&2; exit 1"),
              AllOf(HasSubstr("there is no picture "), HasSubstr("trajectory.png: no OpenGL: it is not here"),
                    Not(HasSubstr("noise")), Not(HasSubstr("rumi view"))));
  EXPECT_FALSE(fs::exists(folder_ / "trajectory.png"));
  EXPECT_THAT(draw("kill -ABRT $$"), HasSubstr("drawing it killed by signal 6"));
  EXPECT_THAT(draw_run_picture(folder_.path().string(), "/no/such/program").error_text(), HasSubstr("No such file"));
}

}  // namespace
}  // namespace rumi::tool
