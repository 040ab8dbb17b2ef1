// SPDX-License-Identifier: BSD-3-Clause
#include "camera_driver/recording/foreign_recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "camera_driver/open_source.h"
#include "tests/support/temporary_folder.h"

namespace rumi::camera_driver {
namespace {

using namespace std::string_literals;
using rumi::testing::TemporaryFolder;
using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(ForeignRecording, RosBagsAreKnownByWhatTheyBeginWith) {
  const TemporaryFolder folder;
  EXPECT_THAT(advice_on_foreign_recording(folder.write("walk", "#ROSBAG V2.0\nE")), HasSubstr("is a ROS 1 bag"));
  EXPECT_THAT(advice_on_foreign_recording(folder.write("walk.x", "\x89MCAP0\r\n\x01")), HasSubstr("MCAP"));
  EXPECT_THAT(advice_on_foreign_recording(folder.write("walk.db3", "SQLite format 3\0"s)), HasSubstr("a ROS 2 bag"));
}

TEST(ForeignRecording, AFolderOfARos2BagIsKnownByItsMetadata) {
  const TemporaryFolder folder;
  EXPECT_EQ(advice_on_foreign_recording(folder.path()), "");
  folder.write("metadata.yaml", "rosbag2_bagfile_information:\n  version: 5\n");
  EXPECT_THAT(advice_on_foreign_recording(folder.path()), HasSubstr("the folder of a ROS 2 bag"));
}

TEST(ForeignRecording, AMapIsNone) {
  const TemporaryFolder folder;
  const std::string map = folder.write("map.db", "SQLite format 3\0"s);
  EXPECT_THAT(advice_on_foreign_recording(map), HasSubstr("is a database and no recording; the map of a run"));
  EXPECT_EQ(advice_on_foreign_recording(folder.path()), "");
  folder.write("run.json", "{}");
  EXPECT_THAT(open_recording(folder.path().string(), {}).error,
              AllOf(HasSubstr("is the output folder of a run and no recording"), HasSubstr("rumi export-map")));
  folder.write("rgb.txt", "");
  EXPECT_EQ(advice_on_foreign_recording(folder.path()), "") << "a run wrote into the folder of its recording";
}

TEST(ForeignRecording, OthersAreKnownByTheirNames) {
  const TemporaryFolder folder;
  EXPECT_THAT(advice_on_foreign_recording(folder.write("walk.SVO2", "x")), HasSubstr("ZED"));
  EXPECT_EQ(advice_on_foreign_recording(folder.write("walk.mp4", "x")), "");
  EXPECT_EQ(advice_on_foreign_recording("/nowhere"), "");
}

TEST(ForeignRecording, IsRefusedByNameWithHowToGetImages) {
  const TemporaryFolder folder;
  const std::string error = open_recording(folder.write("walk.bag", "#ROSBAG V2.0\nE"), {}).error;
  EXPECT_THAT(error, AllOf(HasSubstr("walk.bag: is a ROS 1 bag"), HasSubstr("rosbags"), HasSubstr("--camera FILE")));
}

}  // namespace
}  // namespace rumi::camera_driver
