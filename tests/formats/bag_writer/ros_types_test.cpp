// SPDX-License-Identifier: BSD-3-Clause
#include "formats/bag_writer/ros_types.h"

#include <gtest/gtest.h>

namespace rumi {
namespace {

TEST(RosTypes, BringTheDefinitionsOfTheirParts) {
  const std::string line(80, '=');
  EXPECT_EQ(definition_of(kCompressedImageType, Ros::k1),
            "std_msgs/Header header\nstring format\nuint8[] data\n" + line +
                "\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n");
  EXPECT_EQ(definition_of(kCompressedImageType, Ros::k2),
            "std_msgs/Header header\nstring format\nuint8[] data\n" + line +
                "\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n" + line +
                "\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n");
}

TEST(RosTypes, EachPartStandsOnce) {
  const std::string path = definition_of(kPathType, Ros::k2), header = "MSG: std_msgs/Header\n";
  ASSERT_NE(path.find(header), std::string::npos);
  EXPECT_EQ(path.find(header), path.rfind(header));
  EXPECT_NE(path.find("MSG: geometry_msgs/Quaternion\n"), std::string::npos);
}

TEST(RosTypes, HaveTheNamesOfTheirRos) {
  EXPECT_EQ(full_name(kImageType, Ros::k1), "sensor_msgs/Image");
  EXPECT_EQ(full_name(kImageType, Ros::k2), "sensor_msgs/msg/Image");
}

}  // namespace
}  // namespace rumi
