// SPDX-License-Identifier: BSD-3-Clause
// Writes a bag with some images, and plays it.
#pragma once

#include <gmock/gmock.h>

#include "camera_driver/open_source.h"
#include "tests/formats/bag/write_bag.h"
#include "tests/formats/recording.h"

namespace rumi::camera_driver {

class Bags : public ::testing::Test {
 protected:
  static constexpr int64_t kFirst_ns = 1'000'000'000'000, kStep_ns = 100'000'000, kRecordedLater_ns = 5'000'000'000;
  static int64_t stamp_ns(int i) { return kFirst_ns + i * kStep_ns; }

  void add(const std::string& topic, const std::string& type, int i, const std::string& message) {
    messages_.push_back({topic, type, message, stamp_ns(i) + kRecordedLater_ns});
  }
  void add_image(const std::string& kind, int i, const std::string& topic = "/cam0/image_raw") {
    const std::string message =
        testing::image_message(testing::is_ros2(kind), stamp_ns(i), testing::picture(i), "mono8");
    add(topic, "sensor_msgs/Image", i, message);
  }
  void add_info(const std::string& kind, const testing::InfoToWrite& info = {},
                const std::string& topic = "/cam0/camera_info") {
    add(topic, "sensor_msgs/CameraInfo", 0, testing::info_message(testing::is_ros2(kind), stamp_ns(0), info));
  }
  // Adds a calibration, and images among other messages.
  void add_usual(const std::string& kind, int images) {
    messages_.clear();
    add_info(kind);
    for (int i = 0; i < images; ++i) {
      add_image(kind, i);
      add("/imu", "sensor_msgs/Imu", i, std::string(100, 'x'));
    }
  }
  std::string write(const std::string& kind) { return testing::write_bag(folder_.path().string(), kind, messages_); }
  OpenedSource open(const std::string& file) { return open_recording(file, options_); }
  std::string error_of(const std::string& file) { return open(file).error_text(); }
  // Returns all images of a recording that can be opened.
  std::vector<image_t> play(const std::string& file) {
    const OpenedSource opened = open(file);
    EXPECT_EQ(opened.error_text(), "") << file;
    std::vector<image_t> images;
    while (std::optional<image_t> image = opened.has_value() ? (*opened)->next() : std::nullopt)
      images.push_back(std::move(*image));
    if (opened.has_value()) skipped_ = (*opened)->skipped();
    if (opened.has_value()) camera_ = (*opened)->camera();
    return images;
  }
  void give_calibration() { options_.camera_file = folder_.write("c.yaml", testing::kCalibration); }

  testing::TemporaryFolder folder_;
  std::vector<testing::BagMessageToWrite> messages_;
  CameraOptions options_;
  SkippedFrames skipped_;
  Camera camera_;
};

}  // namespace rumi::camera_driver
