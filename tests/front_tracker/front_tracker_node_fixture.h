// SPDX-License-Identifier: BSD-3-Clause
// A front_tracker on a bus, with a stand-in for map_server that applies every update.
#pragma once

#include <gmock/gmock.h>

#include <algorithm>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "bus/transport/memory_bus.h"
#include "bus/wire/calibration.h"
#include "bus/wire/image_codec.h"
#include "bus/wire/jpeg_image.h"
#include "bus/wire/submap_update.h"
#include "front_tracker/front_tracker_node.h"
#include "lcmtypes/rumi/track_t.hpp"
#include "synth/sequence_renderer.h"

namespace rumi::testing {
using namespace rumi::front_tracker;

inline FrontTrackerOptions node_options() {
  FrontTrackerOptions options;
  options.mapping_thread = false;
  options.mapping.keyframe_images = 5;  // fewer than the keyframes, so that keypoints that have moved are sent again
  return options;
}

class FrontTrackerNodeTest : public ::testing::Test {
 protected:
  explicit FrontTrackerNodeTest(const FrontTrackerOptions& options = node_options())
      : receiver_(bus_, channels::kSubmap, channels::kSubmapAck, "server", true,
                  [this](const auto& p) { return store(p); }) {
    node_ = std::make_unique<FrontTrackerNode>(bus_, options);
    bus_.subscribe<track_t>(channels::kTrack, {}, [this](const track_t& t) { tracks_.push_back(t); });
  }

  ChunkReceiver::Verdict store(const ChunkReceiver::Payload& payload) {
    submap_update_t update;
    EXPECT_TRUE(Bus::decode(std::span<const uint8_t>(payload.bytes), &update));
    Submap& copy = copies_[{update.session, update.submap_id}];
    const std::string error = apply_submap_update(update, &copy).error_text();
    EXPECT_EQ(error, "");
    return {error.empty(), error, copy.revision};
  }

  image_t image(int64_t utime_us, const cv::Mat& grey, bool calibrated = true) {
    image_t message = make_jpeg_image(utime_us, grey);
    if (calibrated) set_metadata(&message, kCalibrationKey, camera_to_yaml(camera_));
    return message;
  }

  synth::SynthOptions walk(double seconds) const {
    synth::SynthOptions options;
    options.seconds = seconds;
    options.rate_hz = 20;
    options.grey = true;
    options.camera = camera_;
    options.exposure_s = 0;
    return options;
  }

  // Gives the node the images of a walk.
  void give_walk(double seconds) {
    synth::SequenceRenderer renderer(walk(seconds));
    for (int i = 0; i < renderer.frames(); ++i) give(image(renderer.utime_us(i), renderer.render(i)));
  }
  void give_it_time_to_finish() {
    for (int i = 0; i < 500 && !node_->finished(); ++i) {
      bus_.set_now_us(bus_.now_us() + 100'000);
      tick();
    }
  }
  void give(const image_t& message) {
    bus_.set_now_us(std::max(bus_.now_us() + 1, message.utime));
    bus_.publish(channels::kCamera, message);
    bus_.dispatch();
    tick();
  }
  void tick() {
    node_->tick(bus_.now_us());
    receiver_.tick(bus_.now_us());
    bus_.dispatch();
  }

  MemoryBus bus_;
  std::map<SubmapKey, Submap> copies_;
  ChunkReceiver receiver_;
  std::unique_ptr<FrontTrackerNode> node_;
  std::vector<track_t> tracks_;
  Camera camera_ = synth::default_synth_camera(320, 240);
  const cv::Mat grey_ = cv::Mat(240, 320, CV_8U, cv::Scalar(99));
};

}  // namespace rumi::testing
