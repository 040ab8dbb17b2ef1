// SPDX-License-Identifier: BSD-3-Clause
#include "formats/bag/bag_poses.h"

#include "tests/formats/bag/bag_fixture.h"

namespace rumi::camera_driver {
namespace {

using namespace testing;
using ::testing::HasSubstr;

// Writes a bag as those of TUM RGB-D: the Kinect's place in the world, the fixed places of its cameras on it, depth
// images.
class BagPosesTest : public Bags {
 protected:
  static constexpr const char* kFrame = "/openni_rgb_optical_frame";
  void add_transforms(const std::string& kind, int i, const std::vector<TransformToWrite>& transforms,
                      const std::string& type = "tf/tfMessage") {
    add("/tf", type, i, transforms_message(is_ros2(kind), transforms));
  }
  void add_tum(const std::string& kind, int poses) {
    messages_.clear();
    const double half = std::sqrt(0.5);
    for (int i = 0; i < poses; ++i) {
      add("/camera/rgb/image_color", "sensor_msgs/Image", i,
          image_message(is_ros2(kind), stamp_ns(i), picture(i, 64, 48, true), "rgb8", false, kFrame));
      add("/camera/depth/image", "sensor_msgs/Image", i,
          image_message(is_ros2(kind), stamp_ns(i), cv::Mat(48, 64, CV_32FC1, cv::Scalar(1)), "32FC1", false, kFrame));
      add("/imu", "sensor_msgs/Imu", i, std::string(100, 'x'));
      // The Kinect is turned by a quarter about z, and moves along x.
      add_transforms(kind, i, {{stamp_ns(i) + 7'000'000, "/world", "/kinect", {1. * i, 0, 0}, {0, 0, half, half}}});
      add_transforms(kind, i,
                     {{stamp_ns(i), "/kinect", "/openni_camera", {0, 0.5, 0}},
                      {stamp_ns(i), "/openni_camera", kFrame, {0, 0, 0.25}},
                      {stamp_ns(i), "/openni_camera", "/openni_depth_frame", {9, 9, 9}}});
    }
  }
};

TEST_F(BagPosesTest, OfTumAreThoseOfTheImagesFrameInTheWorld) {
  for (const char* kind : {"ros1 bz2", "ros1 none", "mcap zstd", "sqlite"}) {
    add_tum(kind, 5);
    const BagPoses poses = poses_in_bag(write(kind), CameraOptions{}.log_channel);
    ASSERT_EQ(poses.error, "") << kind;
    ASSERT_EQ(poses.poses.size(), 5u);
    EXPECT_EQ(poses.poses[3].utime_us, stamp_ns(3) / 1000 + 7000);
    EXPECT_LT((poses.poses[3].map_from_cam.translation - Eigen::Vector3d(2.5, 0, 0.25)).norm(), 1e-12);
    EXPECT_THAT(poses.note, HasSubstr("'openni_rgb_optical_frame' in 'world'"));
  }
}

TEST_F(BagPosesTest, TheImagesAreThoseOfTheColourCamera) {
  add_tum("ros1 none", 5);
  add("/camera/rgb/camera_info", "sensor_msgs/CameraInfo", 0, info_message(false, stamp_ns(0)));
  EXPECT_EQ(play(write("ros1 none")).size(), 5u);
}

TEST_F(BagPosesTest, ThatAreNotTheCamerasAreRefused) {
  const auto error_with = [&](const std::vector<TransformToWrite>& transforms) {
    messages_.clear();
    add_image("mcap", 0);
    add_image("mcap", 1);
    add_transforms("mcap", 0, transforms, "tf2_msgs/TFMessage");
    return poses_in_bag(write("mcap"), CameraOptions{}.log_channel).error;
  };
  EXPECT_THAT(error_with({{1, "world", "drone", {1, 0, 0}}}), HasSubstr("the frame of its images ('camera') is none"));
  EXPECT_THAT(error_with({{1, "world", "camera", {1, 0, 0}}, {2, "world", "camera", {1, 0, 0}}}),
              HasSubstr("does not move"));
  EXPECT_THAT(error_with({{1, "world", "camera", {1, 0, 0}}, {2, "map", "camera", {2, 0, 0}}}),
              HasSubstr("'camera' lies now in one, now in another"));
  EXPECT_THAT(error_with({{1, "a", "camera", {1, 0, 0}}, {2, "camera", "a", {2, 0, 0}}}), HasSubstr("now in another"));
  EXPECT_THAT(error_with({{1, "odom", "camera", {1, 0, 0}},
                          {2, "odom", "camera", {2, 0, 0}},
                          {1, "map", "odom", {1, 0, 0}},
                          {2, "map", "odom", {2, 0, 0}}}),
              HasSubstr("several that move (of the frames camera, odom)"));
  EXPECT_THAT(error_with({{1, "world", "camera", {1, 0, 0}, {0, 0, 0, 0}}}), HasSubstr("is none of its transforms"));
}

TEST_F(BagPosesTest, OfABagWithoutTransformsThereAreNone) {
  add_usual("ros1 none", 3);
  const BagPoses poses = poses_in_bag(write("ros1 none"), CameraOptions{}.log_channel);
  EXPECT_FALSE(poses.has_transforms);
  EXPECT_THAT(poses.error, HasSubstr("no transforms of frames"));
}

TEST_F(BagPosesTest, CutOffMessagesAreLeftOut) {
  add_tum("ros1 none", 4);
  for (BagMessageToWrite& message : messages_)
    if (message.topic == "/tf" && message.time_ns == stamp_ns(2) + kRecordedLater_ns) message.bytes.resize(40);
  const BagPoses poses = poses_in_bag(write("ros1 none"), CameraOptions{}.log_channel);
  EXPECT_EQ(poses.poses.size(), 3u);
}

}  // namespace
}  // namespace rumi::camera_driver
