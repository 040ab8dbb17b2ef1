// SPDX-License-Identifier: BSD-3-Clause
// A ROS bag, read as a recording and as a truth. Byte 0 chooses the file's extension and the options.
#include "bus/wire/calibration.h"
#include "camera_driver/open_source.h"
#include "formats/bag/bag_poses.h"
#include "fuzz/good_messages.h"
#include "fuzz/scratch.h"
#include "tests/formats/bag/write_bag.h"
#include "tests/formats/recording.h"

namespace rumi::fuzz {
namespace {

constexpr int kMostImages = 8;

const char* extension_by(uint8_t choice) {
  const char* const kExtensions[] = {".bag", ".mcap", ".db3", ".bag"};
  return kExtensions[choice & 3];
}

void run(View input) {
  if (input.empty()) return;
  camera_driver::CameraOptions options;
  if ((input[0] & 4) != 0)
    options.camera_file = scratch().write("calibration.yaml", to_bytes(camera_to_yaml(good_camera())));
  if ((input[0] & 8) != 0) options.log_channel = "/cam1/image_raw";
  options.encoding = (input[0] & 16) != 0 ? "rgb" : "auto";
  const std::string file = scratch().write(std::string("bag") + extension_by(input[0]), input.subspan(1));
  const camera_driver::OpenedSource opened = camera_driver::open_recording(file, options);
  for (int i = 0; opened && i < kMostImages && (*opened)->next(); ++i) {
  }
  poses_in_bag(file, options.log_channel);
}

std::vector<testing::BagMessageToWrite> messages(bool is_ros2, const std::string& encoding, int type) {
  std::vector<testing::BagMessageToWrite> all;
  std::vector<uint8_t> png;
  cv::imencode(".png", testing::picture(1), png);
  all.push_back({"/cam0/camera_info", "sensor_msgs/CameraInfo", testing::info_message(is_ros2, 0), 1});
  for (int i = 1; i < 4; ++i) {
    const cv::Mat pixels(48, 64, type, cv::Scalar::all(i));
    all.push_back({"/cam0/image_raw", "sensor_msgs/Image",
                   testing::image_message(is_ros2, i * 100'000'000, pixels, encoding), i * 100'000'000});
    all.push_back({"/cam1/image_raw", "sensor_msgs/CompressedImage",
                   testing::compressed_message(is_ros2, i * 100'000'000, "png", png), i * 100'000'000});
    all.push_back({"/imu", "sensor_msgs/Imu", "x", i * 100'000'000});
    all.push_back({"/tf", "tf2_msgs/TFMessage",
                   testing::transforms_message(is_ros2, {{i * 100'000'000, "world", "body", {0.1 * i, 0, 0}},
                                                         {i * 100'000'000, "body", "camera"}}),
                   i * 100'000'000});
  }
  return all;
}

std::vector<Bytes> seeds() {
  std::vector<Bytes> all;
  for (const std::string& kind : testing::bag_kinds())
    for (const auto& [encoding, type] :
         {std::pair{"mono8", CV_8UC1}, {"bayer_rggb16", CV_16UC1}, {"yuv422", CV_8UC2}}) {
      std::vector<testing::BagMessageToWrite> bag = messages(testing::is_ros2(kind), encoding, type);
      const bool is_one_camera = all.size() % 2 == 0;
      if (is_one_camera) std::erase_if(bag, [](const auto& message) { return message.topic == "/cam1/image_raw"; });
      const int choice = (kind == "sqlite" ? 2 : testing::is_ros2(kind) ? 1 : 0) + (is_one_camera ? 0 : 8 + 4);
      all.push_back(to_bytes(std::string(1, static_cast<char>(choice)) +
                             testing::read_file(testing::write_bag(scratch().folder(), kind, bag))));
    }
  return all;
}

const Registered registered({"ros_bag", run, seeds});

}  // namespace
}  // namespace rumi::fuzz
