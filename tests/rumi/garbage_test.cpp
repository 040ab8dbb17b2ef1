// SPDX-License-Identifier: BSD-3-Clause
// Publishes ten thousand random, truncated and bit-flipped messages on the channels that the processes listen to. No
// process may end, and all must still do their work afterwards.
#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include <random>

#include "bus/transport/memory_bus.h"
#include "bus/wire/calibration.h"
#include "bus/wire/image_codec.h"
#include "bus/wire/image_masks.h"
#include "bus/wire/pose.h"
#include "bus/wire/submap_update.h"
#include "front_tracker/front_tracker_node.h"
#include "lcmtypes/rumi/map_request_t.hpp"
#include "lcmtypes/rumi/mask_t.hpp"
#include "lcmtypes/rumi/track_t.hpp"
#include "map_server/map_server_node.h"
#include "ruminator/ruminator_node.h"
#include "viewer_offscreen/viewer_node.h"

namespace rumi::tool {
namespace {

constexpr int kMessagesPerChannel = 10'000;

class Disturber {
 public:
  std::vector<uint8_t> disturb(const std::vector<uint8_t>& good) {
    std::vector<uint8_t> bytes = good;
    switch (rng_() % 4) {
      case 0:  // noise
        bytes.resize(rng_() % 400);
        for (uint8_t& b : bytes) b = static_cast<uint8_t>(rng_());
        break;
      case 1:  // truncated
        bytes.resize(rng_() % bytes.size());
        break;
      default:  // the fingerprint stays, some bytes after it are wrong
        for (size_t i = 0; i < 1 + rng_() % 6; ++i)
          bytes[8 + rng_() % (bytes.size() - 8)] = static_cast<uint8_t>(rng_());
    }
    return bytes;
  }

 private:
  std::mt19937 rng_{77};
};

image_t small_image(int64_t utime_us) {
  Camera camera;
  camera.width = 96;
  camera.height = 64;
  camera.fx = camera.fy = 80;
  camera.cx = 48;
  camera.cy = 32;
  cv::Mat grey(64, 96, CV_8U);
  for (int i = 0; i < grey.rows * grey.cols; ++i) grey.data[i] = static_cast<uint8_t>(i * i % 251);
  image_t image = make_grey_image(utime_us, grey);
  set_metadata(&image, kCalibrationKey, camera_to_yaml(camera));
  return image;
}

submap_update_t small_update() {
  Submap map;
  map.key = {5, 1};
  map.revision = 3;
  map.camera = parse_calibration(std::string(metadata(small_image(1), kCalibrationKey)), "test").value().camera;
  auto features = std::make_shared<Features>();
  for (int i = 0; i < 10; ++i) {
    features->keypoints.push_back({{5.0f * static_cast<float>(i), 9}, 0, 0});
    features->descriptors.push_back({static_cast<uint64_t>(i), 1, 2, 3});
  }
  for (int id = 0; id < 2; ++id) {
    Keyframe& kf = map.keyframes[id];
    kf.id = id;
    kf.utime_us = 100 + id;
    kf.features = features;
    kf.landmark_ids.assign(10, kNone);
    kf.revision = kf.created_revision = 2;
    map.frames.set({kf.utime_us, id, SE3(), 2});
  }
  map.landmarks[0].id = 0;
  map.landmarks[0].position = {0, 0, 1};
  map.add_observation(0, 0, 1);
  map.add_observation(0, 1, 2);
  return make_submap_update(map, 0);
}

chunk_t chunk_of(const std::vector<uint8_t>& payload, int64_t transfer_id) {
  chunk_t chunk{};
  chunk.sender = "somebody";
  chunk.transfer_id = transfer_id;
  chunk.kind = chunk_t::SUBMAP_UPDATE;
  chunk.count = 1;
  chunk.total_size = chunk.size = static_cast<int32_t>(payload.size());
  chunk.data = payload;
  return chunk;
}

TEST(Garbage, NoProcessEndsAndAllGoOn) {
  spdlog::set_level(spdlog::level::off);
  MemoryBus bus;
  front_tracker::FrontTrackerOptions front_options;
  front_options.mapping_thread = false;
  front_tracker::FrontTrackerNode front(bus, front_options);
  ruminator::RuminatorOptions announce_only;
  announce_only.rebuild = false;
  ruminator::RuminatorNode ruminator(bus, announce_only, {});
  map_server::MapServerOptions server_options;
  server_options.database = ":memory:";
  map_server::MapServerNode server(bus, server_options);
  viewer_offscreen::ViewerNode viewer(bus, {});
  const std::vector<Node*> nodes{&front, &ruminator, &server, &viewer};

  track_t track{};
  track.session = 5;
  track.submap_id = 1;
  track.state = track_t::TRACKING;
  track.cam_from_keyframe = track.cam_from_submap = to_wire(SE3());
  map_status_t status{};
  status.nsubmaps = 1;
  status.submaps.resize(1);
  status.submaps[0].map_from_submap = to_wire(Sim3());
  mask_t mask{};
  mask.stream = mask.session = 5;
  mask.width = 64;
  mask.height = 48;
  mask.left_out = 0.5;
  const std::string png = encode_mask(cv::Mat(48, 64, CV_8U, cv::Scalar(255)));
  mask.size = static_cast<int32_t>(png.size());
  mask.png.assign(png.begin(), png.end());
  map_request_t request{};
  request.requester = "somebody";
  chunk_ack_t ack{};
  ack.sender = "somebody";
  const std::vector<std::pair<std::string, std::vector<uint8_t>>> good{
      {channels::kCamera, encode_message(small_image(1000))},
      {channels::kTrack, encode_message(track)},
      {channels::kSubmap, encode_message(chunk_of(encode_message(small_update()), 1))},
      {channels::kSubmapAck, encode_message(ack)},
      {channels::kMapStatus, encode_message(status)},
      {channels::kMapRequest, encode_message(request)},
      {channels::kMapChunk, encode_message(chunk_of({1, 2, 3}, 2))},
      {channels::kMapAck, encode_message(ack)},
  };
  const std::vector<uint8_t> good_mask = encode_message(mask);
  Disturber disturber, of_masks;
  for (int i = 0; i < kMessagesPerChannel; ++i) {
    bus.set_now_us(10'000 * (i + 1));
    for (const auto& [channel, bytes] : good) bus.publish_raw(channel, disturber.disturb(bytes));
    bus.publish_raw(channels::kMask, of_masks.disturb(good_mask));
    bus.dispatch();
    if (i % 100 != 0) continue;
    for (Node* node : nodes) {
      node->tick(bus.now_us());
      node->status();
    }
    bus.dispatch();
  }

  // The processes still work: an image is answered, a submap is stored.
  int answers = 0;
  bus.subscribe<track_t>(channels::kTrack, {}, [&](const track_t&) { ++answers; });
  // A wrong time in the far future may have been accepted. Then these images begin a new session.
  for (int i = 0; i < 30; ++i) bus.publish(channels::kCamera, small_image(bus.now_us() + 1000 * i));
  submap_update_t update = small_update();
  update.session = bus.now_us() + 1;  // a session that is later than all others
  const std::vector<uint8_t> payload = encode_message(update);
  ChunkSender sender(bus, channels::kSubmap, channels::kSubmapAck, "honest");
  bool done = false;
  sender.send("", chunk_t::SUBMAP_UPDATE, 0, payload, [&](const TransferResult& r) { done = r.ok; });
  bus.dispatch();
  for (Node* node : nodes) node->tick(bus.now_us());
  bus.dispatch();
  EXPECT_GT(answers, 0);
  EXPECT_TRUE(done) << "map_server no longer stores submaps";
}

}  // namespace
}  // namespace rumi::tool
