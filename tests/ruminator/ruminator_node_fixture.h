// SPDX-License-Identifier: BSD-3-Clause
// A ruminator on a bus in memory, to which images and tracking states are sent.
#pragma once

#include <gmock/gmock.h>

#include <memory>
#include <opencv2/core.hpp>
#include <set>
#include <string>
#include <vector>

#include "bus/transport/memory_bus.h"
#include "bus/wire/calibration.h"
#include "bus/wire/image_codec.h"
#include "bus/wire/image_stream.h"
#include "bus/wire/jpeg_image.h"
#include "bus/wire/pose.h"
#include "ruminator/ruminator_node.h"
#include "tests/ruminator/test_jobs.h"

namespace rumi::testing {

inline constexpr int64_t kPeriodUs = 33'333;

class RuminatorNodeTest : public ::testing::Test {
 protected:
  RuminatorNodeTest() {
    options_.rebuild = false;
    options_.build_thread = false;
    options_.spool.clear();
  }
  void start() {
    RuminatorHooks hooks;
    hooks.builder = fake_builder();
    hooks.builder_problem = [this] { return builder_problem_; };
    hooks.on_job = [this](const WindowJob& job) { jobs_.push_back(job); };
    node_ = std::make_unique<RuminatorNode>(bus_, options_, hooks);
    bus_.subscribe<window_t>(channels::kWindow, {}, [this](const window_t& w) { announced_.push_back(w); });
  }
  static image_t make_image(int64_t utime_us, bool is_jpeg = true) {
    cv::Mat grey(120, 160, CV_8U);
    cv::RNG rng(utime_us);
    rng.fill(grey, cv::RNG::UNIFORM, 0, 255);
    image_t image = is_jpeg ? make_jpeg_image(utime_us, grey) : make_grey_image(utime_us, grey);
    set_metadata(&image, kCalibrationKey, camera_to_yaml(small_camera()));
    return image;
  }
  void send_image(int64_t utime_us) {
    image_t image = make_image(utime_us, jpeg_);
    if (stream_ != kNoStream) set_stream(stream_, &image);
    bus_.publish(channels::kCamera, image);
  }
  void send_track(int64_t utime_us, int32_t submap, bool is_keyframe) {
    track_t track{};
    track.utime = utime_us;
    track.session = 7 + stream_;
    track.stream = stream_;
    track.state = submap == kNoSubmap ? track_t::LOST : track_t::TRACKING;
    track.submap_id = submap;
    track.cam_from_submap = to_wire(SE3());
    track.is_keyframe = is_keyframe;
    bus_.publish(channels::kTrack, track);
  }
  // Sends images, each followed by its state, as in live operation.
  void frames(int count, int32_t submap, int keyframe_every = 5) {
    for (int i = 0; i < count; ++i) {
      next();
      send_image(now_);
      bus_.dispatch();
      send_track(now_, submap, submap != kNoSubmap && i % keyframe_every == 0);
      bus_.dispatch();
      node_->tick(now_);
      bus_.dispatch();
    }
  }
  void next() {
    now_ += kPeriodUs;
    bus_.set_now_us(now_);
  }
  void expect_images_of(const WindowJob& job) {
    std::set<int64_t> utimes;
    for (const image_t& image : job.images) utimes.insert(image.utime);
    for (const Sample& s : job.window.samples()) EXPECT_TRUE(utimes.contains(s.utime_us)) << "window " << job.window.id;
  }

  MemoryBus bus_;
  RuminatorOptions options_;
  std::unique_ptr<RuminatorNode> node_;
  std::vector<window_t> announced_;
  std::vector<WindowJob> jobs_;
  std::string builder_problem_;
  int64_t now_ = 1'000'000;
  bool jpeg_ = true;
  int64_t stream_ = kNoStream;
};

}  // namespace rumi::testing
