// SPDX-License-Identifier: BSD-3-Clause
#include "formats/truth/trajectory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/support/temporary_folder.h"

namespace rumi {
namespace {

using ::testing::HasSubstr;

class TrajectoryTest : public ::testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& text) {
    const auto file = folder_ / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file) << text;
    return file.string();
  }
  const testing::TemporaryFolder temporary_;
  const std::filesystem::path folder_ = temporary_.path();
};

TEST_F(TrajectoryTest, ReadsTumLinesToTheMicrosecondInOrderOfTime) {
  const auto result = read_trajectory(write("t.txt",
                                            "# comment\n"
                                            "1400000000.033333 1 2 3 0 0 0 1\r\n"
                                            "\n"
                                            "1400000000.000001\t4 5 6 0 0.6 0 0.8\n"));
  ASSERT_TRUE(result.ok()) << result.error;
  ASSERT_EQ(result.poses.size(), 2u);
  EXPECT_EQ(result.poses[0].utime_us, 1400000000000001);
  EXPECT_EQ(result.poses[1].utime_us, 1400000000033333);
  EXPECT_EQ(result.poses[0].map_from_cam.translation, Eigen::Vector3d(4, 5, 6));
  EXPECT_NEAR(result.poses[0].map_from_cam.rotation.y(), 0.6, 1e-12);
  EXPECT_NEAR(result.poses[0].map_from_cam.rotation.w(), 0.8, 1e-12);
}

TEST_F(TrajectoryTest, SkipsAndCountsBrokenLines) {
  const auto result = read_trajectory(write("t.txt",
                                            "1 nan 2 3 0 0 0 1\n"
                                            "2 1 2 inf 0 0 0 1\n"
                                            "3 1 2 3 0 0 0\n"
                                            "4 1 2 3 0 0 0 0\n"
                                            "5 1 2 3 x 0 0 1\n"
                                            "1e300 1 2 3 0 0 0 1\n"
                                            "6 1 2 3 0 0 0 1\n"
                                            "6 9 9 9 0 0 0 1\n"));
  ASSERT_TRUE(result.ok()) << result.error;
  ASSERT_EQ(result.poses.size(), 1u);
  EXPECT_EQ(result.poses[0].map_from_cam.translation.x(), 1) << "the first of two poses at one time stays";
  EXPECT_EQ(result.skipped_lines, 7);
}

TEST_F(TrajectoryTest, MayBeEmpty) { EXPECT_TRUE(read_trajectory(write("t.txt", "# nothing was tracked\n")).ok()); }

TEST_F(TrajectoryTest, NamesTheFileThatCannotBeUsed) {
  EXPECT_THAT(read_trajectory((folder_ / "absent.txt").string()).error, HasSubstr("absent.txt"));
  EXPECT_THAT(read_trajectory(folder_.string()).error, HasSubstr("is no file"));
  EXPECT_THAT(read_trajectory(write("picture.png", "\x89PNG\nrubbish\n")).error, HasSubstr("none of 2 lines"));
}

TEST_F(TrajectoryTest, ReadsFramesByColumnName) {
  const auto result = read_frames(write("frames.csv", "utime,submap,state,in_map\n20,-1,LOST,0\n10,3,TRACKING,1\n"));
  ASSERT_TRUE(result.ok()) << result.error;
  ASSERT_EQ(result.frames.size(), 2u);
  EXPECT_EQ(result.frames[0].utime_us, 10);
  EXPECT_EQ(result.frames[0].state, "TRACKING");
  EXPECT_EQ(result.frames[0].submap, 3);
  EXPECT_TRUE(result.frames[0].in_map);
  EXPECT_FALSE(result.frames[0].sigmas.are_known()) << "an older file";
  EXPECT_FALSE(result.frames[1].in_map);
}

TEST_F(TrajectoryTest, ReadsDeviationsWhereThereAreAny) {
  const std::string names = "utime,state,submap,in_map,position_sigma,rotation_sigma_rad,log_scale_sigma\r\n";
  const auto result = read_frames(write("frames.csv", names + "10,TRACKING,1,1,0.5,0.25,0\r\n"
                                                              "20,LOST,0,0,,,\r\n"
                                                              "30,TRACKING,1,1,nan,0.25,0\n"
                                                              "40,TRACKING,1,1,0.5,-1,0\n"
                                                              "50,TRACKING,1,1,0.5,0.25,1e200\n"
                                                              "60,TRACKING,1,1,0.5,,0.1\n\n"));
  ASSERT_TRUE(result.ok()) << result.error;
  ASSERT_EQ(result.frames.size(), 6u);
  EXPECT_EQ(result.frames[0].sigmas, (PoseSigmas{0.5F, 0.25F, 0}));
  for (size_t i = 1; i < 6; ++i) EXPECT_EQ(result.frames[i].sigmas, PoseSigmas()) << i;
  const auto without_one =
      read_frames(write("two.csv", "utime,state,submap,in_map,position_sigma,rotation_sigma_rad\n1,LOST,0,0,1,1\n"));
  ASSERT_TRUE(without_one.ok()) << without_one.error;
  EXPECT_FALSE(without_one.frames[0].sigmas.are_known());
  EXPECT_THAT(read_frames(write("text.csv", names + "10,TRACKING,1,1,much,0.25,0\n")).error, HasSubstr("line 2"));
  EXPECT_THAT(read_frames(write("short.csv", names + "10,TRACKING,1,1\n")).error, HasSubstr("line 2"));
}

TEST_F(TrajectoryTest, RefusesBrokenFramesWithTheLine) {
  EXPECT_THAT(read_frames((folder_ / "absent.csv").string()).error, HasSubstr("absent.csv"));
  EXPECT_THAT(read_frames(write("a.csv", "time,state\n")).error, HasSubstr("columns"));
  EXPECT_THAT(read_frames(write("b.csv", "utime,state,submap,in_map\n1,LOST,-1,0\n2,LOST\n")).error,
              HasSubstr("line 3"));
  EXPECT_THAT(read_frames(write("d.csv", "utime,state,submap,in_map\n-9223372036854775808,LOST,-1,0\n")).error,
              HasSubstr("line 2"));
  EXPECT_THAT(read_frames(write("c.csv", "utime,state,submap,in_map\n1.5,LOST,-1,0\n")).error, HasSubstr("line 2"));
}

}  // namespace
}  // namespace rumi
