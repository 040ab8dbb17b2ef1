// SPDX-License-Identifier: BSD-3-Clause
// Messages to front_tracker: images, the state of the map, and back submaps from map_server. Besides the images in the
// input there are pictures of a small scene that it can track.
#include <array>
#include <random>

#include "bus/process/safe_node.h"
#include "bus/wire/calibration.h"
#include "bus/wire/image_codec.h"
#include "front_tracker/front_tracker_node.h"
#include "fuzz/good_messages.h"

namespace rumi::fuzz {
namespace {

using namespace front_tracker;

enum Channel : uint8_t { kCamera, kStatus, kChunk, kAck };
constexpr int kPictures = 16, kPictureWidth = 160, kPictureHeight = 120;
constexpr int kPatches = 220, kPatchSide = 9;
constexpr double kStep = 0.05;  // sideways motion from one picture to the next, in the scene's unit

Camera picture_camera() {
  Camera camera;
  camera.width = kPictureWidth;
  camera.height = kPictureHeight;
  camera.fx = camera.fy = 120;
  camera.cx = kPictureWidth / 2.0;
  camera.cy = kPictureHeight / 2.0;
  return camera;
}

// Draws patches of noise at places in the scene, the farthest first, as a camera that moves sideways sees them.
std::array<cv::Mat, kPictures> draw_pictures() {
  std::mt19937 random(3);
  const auto uniform = [&](double low, double high) { return low + (high - low) * (random() % 4096) / 4096.0; };
  std::array<cv::Mat, kPictures> pictures;
  for (cv::Mat& picture : pictures) picture = cv::Mat(kPictureHeight, kPictureWidth, CV_8U, cv::Scalar(128));
  const Camera camera = picture_camera();
  for (int p = 0; p < kPatches; ++p) {
    const Eigen::Vector3d position(uniform(-2.5, 3), uniform(-2, 2), 4.5 - 3.0 * p / kPatches);
    cv::Mat patch(kPatchSide, kPatchSide, CV_8U);
    for (int i = 0; i < kPatchSide * kPatchSide; ++i) patch.data[i] = static_cast<uint8_t>(random());
    for (int i = 0; i < kPictures; ++i) {
      const Eigen::Vector2d at = camera.project_undistorted(position - Eigen::Vector3d(kStep * i, 0, 0));
      const cv::Rect area(static_cast<int>(at.x()), static_cast<int>(at.y()), kPatchSide, kPatchSide);
      cv::Mat& picture = pictures[static_cast<size_t>(i)];
      if ((area & cv::Rect(0, 0, picture.cols, picture.rows)) == area) patch.copyTo(picture(area));
    }
  }
  return pictures;
}

void show_picture(MemoryBus& bus, int number) {
  static const std::array<cv::Mat, kPictures> pictures = draw_pictures();
  image_t image = make_grey_image(bus.now_us(), pictures[static_cast<size_t>(number % kPictures)]);
  set_metadata(&image, kCalibrationKey, camera_to_yaml(picture_camera()));
  bus.publish(channels::kCamera, image);
}

void run(View input) {
  MemoryBus bus;
  FrontTrackerOptions options;
  options.mapping_thread = false;
  options.max_image_side = kPictureWidth;
  options.initializer.keypoints = 300;
  options.initializer.min_matches = 40;
  options.orb.keypoints = 200;
  SafeNode node(std::make_unique<FrontTrackerNode>(bus, options), &bus.broken_handlers());
  const Stage stage{.bus = &bus,
                    .node = &node,
                    .channels = {channels::kCamera, channels::kMapStatus, channels::kMapChunk, channels::kSubmapAck},
                    .chunk_channel = channels::kMapChunk,
                    .picture = show_picture};
  play(parse_script(input), stage);
}

std::vector<Bytes> seeds() {
  const auto picture = [](int number) { return Event{Event::kPicture, {static_cast<uint8_t>(number)}}; };
  const SubmapKey back{kSession, -1};
  Script blank, tracked, told;
  for (int i = 1; i < 6; ++i) blank.push_back(message(kCamera, i % 2 ? good_image(i * 10'000) : good_jpeg(i * 10'000)));
  for (int i = 0; i < 12; ++i) tracked.push_back(picture(i));
  told = tracked;
  tracked.push_back(message(kCamera, good_image(kSession * 2)));
  for (int i = 11; i > 7; --i) tracked.push_back(picture(i));
  told.insert(told.begin() + 9, {message(kStatus, good_status({back})), pause(6),
                                 payload(chunk_t::SUBMAP_UPDATE, make_submap_update(good_submap(back, 3), 0))});
  told.push_back(message(kAck, good_ack(1, chunk_ack_t::COMPLETE)));
  return {to_bytes(blank), to_bytes(tracked), to_bytes(told)};
}

const Registered registered({"front_tracker_messages", run, seeds, mutate_script});

}  // namespace
}  // namespace rumi::fuzz
