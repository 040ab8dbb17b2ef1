// SPDX-License-Identifier: BSD-3-Clause
#include "formats/truth/truth.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/support/temporary_folder.h"

namespace rumi {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr int64_t kStart_us = 1'400'000'000'000'000;

class TruthTest : public ::testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& text) {
    const auto file = folder_.path() / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << text;
    return file.string();
  }
  TruthFile read(const std::string& text, const TruthOptions& options = {}) {
    return read_groundtruth(write("t.txt", text), options);
  }
  testing::TemporaryFolder folder_;
};

// Returns options for a recording of three images, 0.1 s apart.
TruthOptions of_run(int64_t first_us = kStart_us, double rate_hz = 0) {
  return {rate_hz, RunTimes{first_us, first_us + 200'000, 100'000}};
}

void expect_the_pose(const TruthFile& result) {
  ASSERT_EQ(result.error, "");
  ASSERT_FALSE(result.poses.empty());
  EXPECT_EQ(result.poses[0].utime_us, kStart_us);
  EXPECT_EQ(result.poses[0].map_from_cam.translation, Eigen::Vector3d(1, 2, 3));
  EXPECT_TRUE(result.has_rotations);
  EXPECT_NEAR(result.poses[0].map_from_cam.rotation.y(), 0.6, 1e-12);
  EXPECT_NEAR(result.poses[0].map_from_cam.rotation.w(), 0.8, 1e-12);
}

TEST_F(TruthTest, OfIclNuimIsMirrored) {
  const std::string text = "0 1 2 3 0.1 0.2 0.3 0.9273618495495703\n1 1 2 4 0 0 0 1\n2 1 3 4 0 0 0 1\n";
  const TruthFile mirrored = read_groundtruth(write("livingRoom0.gt.freiburg", text), of_run(0, 10));
  ASSERT_EQ(mirrored.error, "");
  EXPECT_THAT(mirrored.notes, ::testing::Contains(HasSubstr("whose y points up: mirrored")));
  const SE3 &pose = mirrored.poses[0].map_from_cam, as_written = read(text, of_run(0, 10)).poses[0].map_from_cam;
  EXPECT_EQ(pose.translation, Eigen::Vector3d(1, -2, 3));
  // If a point is mirrored in the camera's frame, its place in the mirrored world is mirrored, too.
  const Eigen::Vector3d point(0.5, 0.25, 2), mirror(1, -1, 1);
  const Eigen::Vector3d there = as_written * point;
  EXPECT_LT((pose * mirror.cwiseProduct(point) - mirror.cwiseProduct(there)).norm(), 1e-12);
  EXPECT_EQ(mirrored.poses[2].utime_us, 200'000);
}

TEST_F(TruthTest, OfTumMayHaveAnySeparator) {
  for (const char* text : {"1400000000.0 1 2 3 0 0.6 0 0.8\n", "1400000000.0\t1\t2\t3\t0\t0.6\t0\t0.8\r\n",
                           "1400000000.0,1,2,3,0,0.6,0,0.8\n", "1400000000.0;1;2;3;0;0.6;0;0.8\n",
                           "1400000000,0;1,0;2,0;3,0;0,0;0,6;0,0;0,8\n", "1400000000.0, 1, 2, 3, 0, 0.6, 0, 0.8,\n",
                           "\"1400000000.0\",\"1\",\"2\",\"3\",\"0\",\"0.6\",\"0\",\"0.8\"\n",
                           "\xEF\xBB\xBF"
                           "1400000000.0 1 2 3 0 0.6 0 0.8\n",
                           "// by us\n% by us\n# by us\n\n1400000000.0 1 2 3 0 +0.6 0 0.8\n"}) {
    const TruthFile result = read(text);
    expect_the_pose(result);
    EXPECT_THAT(result.notes, IsEmpty()) << text;
  }
}

TEST_F(TruthTest, IsReadByTheNamesOfItsColumns) {
  for (const char* text :
       {"time,tx,ty,tz,qx,qy,qz,qw\n1400000000.0,1,2,3,0,0.6,0,0.8\n",
        "timestamp,x,y,z,qw,qx,qy,qz\n1400000000.0,1,2,3,0.8,0,0.6,0\n",
        "# timestamp tx ty tz qw qx qy qz\n1400000000.0 1 2 3 0.8 0 0.6 0\n",
        "%time,field.header.seq,field.pose.position.x,field.pose.position.y,field.pose.position.z,field.pose."
        "orientation.x,"
        "field.pose.orientation.y,field.pose.orientation.z,field.pose.orientation.w\n1400000000000000000,7,1,2,3,0,0.6,"
        "0,0.8\n",
        "\"timestamp "
        "[s]\";\"v_x\";\"p_x\";\"p_y\";\"p_z\";\"q_x\";\"q_y\";\"q_z\";\"q_w\"\n1400000000.0;9;1;2;3;0;0.6;0;0.8\n"})
    expect_the_pose(read(text));
  EXPECT_THAT(read("time,latitude,longitude,altitude\n1400000000.0,49,8,110\n").error, HasSubstr("latitudes"));
}

TEST_F(TruthTest, MayHaveSecondsAndNanosecondsApart) {
  for (const char* heading : {"", "sec,nsec,x,y,z,qx,qy,qz,qw\n", "secs nsecs tx ty tz qx qy qz qw\n",
                              "# stamp.sec stamp.nanosec tx ty tz qx qy qz qw\n"}) {
    std::string text = heading;
    for (const char* nanoseconds : {"0", "50000000", "100000000", "150000000"})
      text += fmt::format("1400000000 {} 1 2 3 0 0.6 0 0.8\n", nanoseconds);
    const TruthFile result = read(text);
    expect_the_pose(result);
    ASSERT_EQ(result.poses.size(), 4u) << heading;
    EXPECT_EQ(result.poses[1].utime_us, kStart_us + 50'000) << heading;
    EXPECT_EQ(result.poses[3].utime_us, kStart_us + 150'000) << heading;
  }
}

TEST_F(TruthTest, TellsWhichLinesAreNoPoses) {
  const TruthFile result = read(
      "1400000000 1 2 3 nan nan nan nan\n1400000000.1 1 2 3 0 0 0 1\n1400000000.2 1 2 3 0 0 0\n1400000000.3 1 2 3 0 0 "
      "0 0.5\n"
      "1400000000.4 1 2 3 0 0 0 1\n1e300 1 2 3 0 0 0 1\n");
  ASSERT_EQ(result.error, "");
  EXPECT_EQ(result.poses.size(), 2u);
  EXPECT_THAT(result.notes, ElementsAre(HasSubstr("3 of 6 lines are no poses (first: line 1, nan)"),
                                        HasSubstr("1 lines have a time")));
  EXPECT_THAT(read("1 2\n").error, HasSubstr("they have 2 numbers"));
  EXPECT_THAT(read("# nothing\n").error, HasSubstr("holds no poses"));
  EXPECT_THAT(read_groundtruth((folder_.path() / "absent.txt").string()).error, HasSubstr("absent.txt"));
  EXPECT_THAT(read_groundtruth(folder_.path().string()).error, HasSubstr("is a folder"));
  EXPECT_THAT(read("\x89PNG\nrubbish\n").error, HasSubstr("none of"));
}

TEST_F(TruthTest, IsSortedAndTold) {
  const TruthFile result = read("1400000000.2 3 0 0 0 0 0 1\n1400000000.0 1 0 0 0 0 0 1\n1400000000.2 9 0 0 0 0 0 1\n");
  ASSERT_EQ(result.poses.size(), 2u);
  EXPECT_EQ(result.poses[0].map_from_cam.translation.x(), 1);
  EXPECT_EQ(result.poses[1].map_from_cam.translation.x(), 3) << "the first of two at one time";
  EXPECT_THAT(result.notes,
              ElementsAre(HasSubstr("go back 1 times"), HasSubstr("1 poses have a time that another one has")));
}

TEST_F(TruthTest, MayBePositionsOnly) {
  for (const char* text :
       {"# time x y z\n1400000000.0 1 2 3\n1400000000.1 1 2 4\n", "1400000000.0,1,2,3,7\n1400000000.1,1,2,4,7\n",
        "1400000000.0 1 2 3 0 0 0 0\n1400000000.1 1 2 4 0 0 0 0\n",
        "time,x,y,z,roll,pitch,yaw\n1400000000.0,1,2,3,0.1,0.2,0.3\n"}) {
    const TruthFile result = read(text);
    ASSERT_EQ(result.error, "");
    EXPECT_FALSE(result.has_rotations);
    EXPECT_EQ(result.poses[0].map_from_cam.translation, Eigen::Vector3d(1, 2, 3));
    EXPECT_THAT(result.notes, ::testing::Contains(HasSubstr("positions"))) << text;
  }
}

TEST_F(TruthTest, UnitsOfTimeAreToldApart) {
  const std::pair<const char*, const char*> kUnits[] = {
      {"000", "milliseconds"}, {"000000", "microseconds"}, {"000000000", "nanoseconds"}};
  for (const auto& [zeros, name] : kUnits) {
    const TruthFile result = read(fmt::format("1400000000{} 1 2 3 0 0.6 0 0.8\n", zeros));
    expect_the_pose(result);
    EXPECT_THAT(result.notes, ElementsAre(HasSubstr(name)));
  }
  EXPECT_EQ(read("1400000000000000999 1 2 3 0 0 0 1\n").poses[0].utime_us, kStart_us);
  EXPECT_EQ(read("1400000000033.5 1 2 3 0 0 0 1\n").poses[0].utime_us, kStart_us + 33'500);
  // Times count from when a device was switched on, 5 s before the first image.
  const std::string since_start = "5000000000 1 2 3 0 0 0 1\n5100000000 1 2 3 0 0 0 1\n5200000000 1 2 3 0 0 0 1\n";
  EXPECT_EQ(read(since_start, of_run(5'000'000)).poses[1].utime_us, 5'100'000);
}

TEST_F(TruthTest, NumbersOfImagesAreNoTimes) {
  const std::string numbers = "1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n3 0 0 0 0 0 0 1\n";
  EXPECT_THAT(read(numbers, of_run(0)).error, AllOf(HasSubstr("counts 1, 2, ..."), HasSubstr("--groundtruth-rate")));
  const TruthFile at_rate = read(numbers, of_run(0, 30));
  ASSERT_EQ(at_rate.poses.size(), 3u);
  EXPECT_EQ(at_rate.poses[0].utime_us, 33'333);
  EXPECT_EQ(at_rate.poses[1].utime_us, 66'667);
  // If images are a second apart, such numbers are times.
  EXPECT_EQ(read(numbers, {0, RunTimes{0, 3'000'000, 1'000'000}}).poses.size(), 3u);
  EXPECT_THAT(read("0 0 0 0 0 0 0 1\n10 0 0 0 0 0 0 1\n20 0 0 0 0 0 0 1\n", of_run(0)).hint,
              HasSubstr("--groundtruth-rate"));
  EXPECT_THAT(read("0.1 0 0 0 0 0 0 1\n", of_run(0, 30)).error, HasSubstr("leave the option out"));
}

TEST_F(TruthTest, OfAnotherKindIsRefusedByItsName) {
  EXPECT_THAT(read("#ROSBAG V2.0\nrubbish\n").error, HasSubstr("is a bag of ROS"));
  EXPECT_THAT(read("\xFF\xFE"
                   "1")
                  .error,
              HasSubstr("UTF-16"));
  EXPECT_THAT(read("{\"frames\": []}").error, HasSubstr("is JSON"));
  EXPECT_THAT(read("1 0 0 0.5\n0 1 0 0.2\n0 0 1 0.1\n0 0 0 1\n").error, HasSubstr("over four lines"));
  EXPECT_THAT(read("0 0 1\n1 0 0 0.5\n0 1 0 0.2\n0 0 1 0.1\n0 0 0 1\n").error, HasSubstr("over four lines"));
  const std::string images =
      "1 0.85 0.17 0.01 0.49 -0.67 1.27 1.02 1 a.jpg\n1.5 2.5 -1\n2 0.8 0.2 0 0.5 -0.6 1.2 1.1 1 b.jpg\n\n";
  for (const std::string& text :
       {images, "# Image list\n#   IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n" + images})
    EXPECT_THAT(read_groundtruth(write("images.txt", text), {30}).error, HasSubstr("COLMAP")) << text;
}

constexpr const char* kKitti =
    "1 0 0 1 0 1 0 2 0 0 1 3\n1 0 0 2 0 1 0 2 0 0 1 3\nnan 0 0 2 0 1 0 2 0 0 1 3\n1 0 0 4 0 1 0 2 0 0 1 3\n";

TEST_F(TruthTest, OfKittiNeedsTimes) {
  const std::string file = write("poses/00.txt", kKitti);
  EXPECT_THAT(read_groundtruth(file).error,
              AllOf(HasSubstr("KITTI"), HasSubstr("--groundtruth-rate"), HasSubstr("times.txt")));
  const TruthFile at_rate = read_groundtruth(file, of_run(0, 10));
  ASSERT_EQ(at_rate.poses.size(), 3u);
  EXPECT_EQ(at_rate.poses[2].utime_us, 300'000) << "the line that is none counts";
  EXPECT_EQ(at_rate.poses[2].map_from_cam.translation, Eigen::Vector3d(4, 2, 3));
  EXPECT_EQ(read_groundtruth(file, of_run(kStart_us, 10)).poses[0].utime_us, kStart_us) << "the first image's";
  write("sequences/00/times.txt", "0.0\n1.037e-01\n2.0e-01\n0.31\n");
  const TruthFile timed = read_groundtruth(file);
  ASSERT_EQ(timed.poses.size(), 3u);
  EXPECT_EQ(timed.poses[1].utime_us, 103'700);
  EXPECT_THAT(timed.notes, ::testing::Contains(HasSubstr("sequences/00/times.txt")));
  write("poses/times.txt", "0.0\n0.1\n");
  EXPECT_THAT(read_groundtruth(file).error, AllOf(HasSubstr("4 lines"), HasSubstr("2 times")));
}

TEST_F(TruthTest, OtherFilesWithoutTimesNeedThem) {
  EXPECT_THAT(read("1 2 3 0 0.6 0 0.8\n").error, HasSubstr("no times"));
  EXPECT_THAT(read("1 2 3\n4 5 6\n").error, HasSubstr("no times"));
  const TruthFile poses = read("1 2 3 0 0.6 0 0.8\n", of_run(kStart_us, 10));
  expect_the_pose(poses);
}

constexpr const char* kEuroc =
    "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []\n"
    "1403715886584058112,1.0,2.0,3.0,0.0,0.0,0.0,1.0\n";
constexpr const char* kHalfAMetre = "T_BS:\n  cols: 4\n  rows: 4\n  data: [1,0,0,0.5, 0,1,0,0, 0,0,1,0, 0,0,0,1]\n";

TEST_F(TruthTest, OfEurocBecomesThatOfTheCamera) {
  write("mav0/cam0/sensor.yaml", kHalfAMetre);
  const auto result = read_groundtruth(write("mav0/state_groundtruth_estimate0/data.csv", kEuroc));
  ASSERT_EQ(result.error, "");
  ASSERT_EQ(result.poses.size(), 1u);
  EXPECT_THAT(result.notes, IsEmpty());
  EXPECT_EQ(result.poses[0].utime_us, 1403715886584058);
  // The body is turned by half a turn about z: the camera, half a metre along the body's x, is at a smaller x.
  EXPECT_NEAR(result.poses[0].map_from_cam.translation.x(), 0.5, 1e-9);
  EXPECT_NEAR(result.poses[0].map_from_cam.translation.y(), 2.0, 1e-9);
}

TEST_F(TruthTest, OfEurocsViconIsThatOfItsMarkers) {
  write("mav0/cam0/sensor.yaml", kHalfAMetre);
  write("mav0/vicon0/sensor.yaml", kHalfAMetre);
  const auto result = read_groundtruth(write("mav0/vicon0/data.csv", kEuroc));
  ASSERT_EQ(result.error, "");
  EXPECT_NEAR(result.poses[0].map_from_cam.translation.x(), 1.0, 1e-9) << "the markers are where the camera is";
}

TEST_F(TruthTest, OfEurocWithoutItsSensorFileIsRefused) {
  EXPECT_THAT(read_groundtruth(write("a/b/data.csv", kEuroc)).error, HasSubstr("sensor.yaml"));
}

TEST_F(TruthTest, OfTumViIsThatOfTheBodyWhereNothingTellsMore) {
  write("mav0/cam0/sensor.yaml", "intrinsics: [1, 2, 3, 4]\n");
  const std::string file = write("mav0/mocap0/data.csv", kEuroc);
  const TruthFile body = read_groundtruth(file);
  ASSERT_EQ(body.error, "");
  EXPECT_FALSE(body.has_rotations);
  EXPECT_EQ(body.poses[0].map_from_cam.translation.x(), 1);
  EXPECT_THAT(body.notes, ElementsAre(AllOf(HasSubstr("the path of the body"), HasSubstr("T_BS"))));
  write("dso/camchain.yaml",
        "cam0:\n  T_cam_imu:\n  - [1, 0, 0, -0.5]\n  - [0, 1, 0, 0]\n  - [0, 0, 1, 0]\n  - [0, 0, 0, 1]\n");
  const TruthFile camera = read_groundtruth(file);
  ASSERT_EQ(camera.error, "");
  EXPECT_TRUE(camera.has_rotations);
  EXPECT_NEAR(camera.poses[0].map_from_cam.translation.x(), 0.5, 1e-9);
}

TEST_F(TruthTest, OfALaserTrackerIsPositions) {
  const TruthFile result = read_groundtruth(
      write("mav0/leica0/data.csv",
            "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m]\n1403715886584058112,1.0,2.0,3.0\n"));
  ASSERT_EQ(result.error, "");
  EXPECT_FALSE(result.has_rotations);
  EXPECT_EQ(result.poses[0].utime_us, 1403715886584058);
  EXPECT_EQ(result.poses[0].map_from_cam.translation, Eigen::Vector3d(1, 2, 3));
}

}  // namespace
}  // namespace rumi
