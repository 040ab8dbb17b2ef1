// SPDX-License-Identifier: BSD-3-Clause
#include "viewer_offscreen/viewer_node.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <memory>
#include <opencv2/videoio.hpp>

#include "bus/transport/memory_bus.h"
#include "bus/wire/image_codec.h"
#include "bus/wire/pose.h"
#include "bus/wire/submap_update.h"
#include "lcmtypes/rumi/map_request_t.hpp"
#include "tests/support/temporary_folder.h"
#include "tests/viewer_offscreen/test_map.h"
#include "viewer_offscreen/canvas/palette.h"
#include "viewer_offscreen/picture/layout.h"

namespace rumi::viewer_offscreen {
namespace {

namespace fs = std::filesystem;

Eigen::Vector3d test_line(double t) { return {0.3, 0.2 * t, 0}; }

// Plays map_server with one submap, whose path in the map is a line once it is placed.
class ViewerNodeTest : public ::testing::Test {
 protected:
  ViewerNodeTest() : sender_(bus_, channels::kMapChunk, channels::kMapAck, "server") {
    bus_.set_now_us(1'000'000);
    bus_.subscribe<map_request_t>(channels::kMapRequest, {}, [this](const map_request_t& r) { on_request(r); });
    bus_.subscribe<image_t>(channels::kViewerImage, {}, [this](const image_t& image) { images_.push_back(image); });
    options_.output = folder_;
    options_.interval_s = 1;
  }

  void on_request(const map_request_t& request) {
    requests_.push_back(request);
    if (request.what == map_request_t::STATUS) return publish_status();
    const bool placed = request.what == map_request_t::PLACED_SUBMAP;
    std::vector<uint8_t> payload =
        encode_message(make_submap_update(placed ? placed_ : submap_, placed ? 0 : request.base_revision));
    if (garbage_-- > 0) payload.assign(100, 0xab);
    sender_.send(request.requester, chunk_t::SUBMAP_UPDATE, request.request_id, payload, [](const TransferResult&) {});
  }
  void publish_status() {
    submap_summary_t summary{};
    summary.session = 1;
    summary.submap_id = listed_;
    summary.in_map = true;
    summary.revision = submap_.revision;
    summary.placement_revision = placement_revision_;
    summary.map_from_submap = to_wire(Sim3());
    map_status_t status{};
    status.utime = bus_.now_us();
    status.front_submaps = in_all_;
    status.nsubmaps = 1;
    status.submaps = {summary};
    bus_.publish(channels::kMapStatus, status);
  }
  void publish_tracks(int8_t state = track_t::TRACKING) {
    for (const auto& [utime_us, frame] : submap_.frames) {
      track_t track{};
      track.utime = utime_us;
      track.session = 1;
      track.state = state;
      track.submap_id = state == track_t::TRACKING ? 1 : kNoSubmap;
      track.cam_from_submap = to_wire(submap_.cam_from_submap(frame));
      bus_.publish(channels::kTrack, track);
    }
  }
  void run(ViewerNode& node, double seconds) {
    for (int i = 0; i < seconds * 10; ++i) {
      bus_.set_now_us(bus_.now_us() + 100'000);
      bus_.dispatch();
      sender_.tick(bus_.now_us());
      node.tick(bus_.now_us());
    }
    bus_.dispatch();
  }

  MemoryBus bus_;
  ChunkSender sender_;
  Submap submap_ = make_test_submap(1, 0, 4, test_circle, 800);
  Submap placed_ = make_test_submap(1, 0, 4, test_line, 800);
  int64_t placement_revision_ = 0;
  int listed_ = 1, in_all_ = 1;
  std::vector<map_request_t> requests_;
  std::vector<image_t> images_;
  int garbage_ = 0;
  const testing::TemporaryFolder temporary_;
  const std::string folder_ = temporary_.path().string();
  ViewerOptions options_;
};

int colour_pixels(const image_t& message, const cv::Vec3b& rgb) {
  const cv::Mat picture = decode_bgr(message).value();
  cv::Mat mask;
  const cv::Scalar bgr(rgb[2], rgb[1], rgb[0]);
  cv::inRange(picture, bgr - cv::Scalar::all(30), bgr + cv::Scalar::all(30), mask);  // JPEG changes colours a little
  return cv::countNonZero(mask);
}

TEST_F(ViewerNodeTest, FetchesTheSubmapAndDrawsIt) {
  ViewerNode node(bus_, options_);
  publish_tracks();
  publish_status();
  run(node, 3);
  ASSERT_GE(images_.size(), 1u);
  EXPECT_EQ(images_.back().width, 1280);
  EXPECT_GT(colour_pixels(images_.back(), submap_color(SubmapKind::kFront, 0)), 300);
  EXPECT_TRUE(fs::exists(folder_ + "/trajectory.png"));
  EXPECT_FALSE(node.status().degraded);
  // Only new elements are requested, and nothing if nothing is new.
  const size_t asked = requests_.size();
  publish_status();
  run(node, 3);
  EXPECT_EQ(requests_.size(), asked);
  ++submap_.revision;
  submap_.landmarks[0].revision = submap_.revision;
  publish_status();
  run(node, 3);
  ASSERT_EQ(requests_.size(), asked + 1);
  EXPECT_EQ(requests_.back().base_revision, 1);
}

// The map has more than one page, and each status brings one.
TEST_F(ViewerNodeTest, TheLastPictureWaitsForAllPages) {
  ViewerNode node(bus_, options_);
  in_all_ = 2;
  publish_status();
  run(node, 2);
  node.finish();
  run(node, 1);
  EXPECT_FALSE(node.finished()) << "a submap has not been told of";
  submap_.key.id = listed_ = 2;
  publish_status();
  run(node, 1);
  EXPECT_TRUE(node.finished());
  EXPECT_NE(node.status().detail.find("2 of 2 submaps up to date"), std::string::npos) << node.status().detail;
}

TEST_F(ViewerNodeTest, APlacedSubmapIsFetchedWholeWhenItMovesOrGrows) {
  ViewerNode node(bus_, options_);
  publish_status();
  run(node, 3);
  ASSERT_EQ(requests_.size(), 1u);
  EXPECT_EQ(requests_.back().what, map_request_t::SUBMAP);
  const image_t before = images_.back();
  placement_revision_ = 7;
  publish_status();
  run(node, 3);
  ASSERT_EQ(requests_.size(), 2u);
  EXPECT_EQ(requests_.back().what, map_request_t::PLACED_SUBMAP);
  const image_t placed = images_.back();
  EXPECT_NE(before.data, placed.data);
  publish_status();
  run(node, 3);
  EXPECT_EQ(requests_.size(), 2u);
  // The submap grows with each status, ten times in three seconds. It is fetched as often as pictures are drawn, once a
  // second.
  for (int i = 0; i < 10; ++i) {
    ++submap_.revision, ++placed_.revision;
    publish_status();
    run(node, 0.3);
  }
  EXPECT_GE(requests_.size(), 4u);
  EXPECT_LE(requests_.size(), 6u);
  // If it is no longer part of a placed map, it is fetched in its own gauge again, from the start.
  placement_revision_ = 0;
  publish_status();
  run(node, 3);
  EXPECT_EQ(requests_.back().what, map_request_t::SUBMAP);
  EXPECT_EQ(requests_.back().base_revision, 0);
  EXPECT_NE(images_.back().data, placed.data);
}

TEST_F(ViewerNodeTest, WhatChangesBetweenTwoPicturesTravelsOnce) {
  options_.interval_s = 5;
  ViewerNode node(bus_, options_);
  publish_tracks();
  for (int i = 0; i < 50; ++i) {
    ++submap_.revision;
    submap_.landmarks[0].revision = submap_.revision;
    publish_status();
    run(node, 0.4);
  }
  EXPECT_GE(images_.size(), 3U);
  EXPECT_LE(requests_.size(), images_.size() + 1);
  EXPECT_GT(colour_pixels(images_.back(), submap_color(SubmapKind::kFront, 0)), 300);
}

TEST_F(ViewerNodeTest, DrawsALastPictureOfTheNewestMap) {
  options_.interval_s = 1000;
  ViewerNode node(bus_, options_);
  publish_tracks();
  node.finish();
  EXPECT_FALSE(node.finished());
  run(node, 2);
  EXPECT_TRUE(node.finished());
  ASSERT_EQ(images_.size(), 1u);
  EXPECT_GT(colour_pixels(images_.back(), submap_color(SubmapKind::kFront, 0)), 300);
}

TEST_F(ViewerNodeTest, EndsWithoutAMapServer) {
  MemoryBus lonely;
  lonely.set_now_us(5);
  ViewerNode node(lonely, options_);
  node.finish();
  for (int i = 1; i < 50; ++i) {
    lonely.set_now_us(i * 100'000);
    node.tick(lonely.now_us());
  }
  EXPECT_TRUE(node.finished());
  EXPECT_TRUE(fs::exists(folder_ + "/trajectory.png"));
}

TEST_F(ViewerNodeTest, GarbageIsRejectedAndAskedForAgain) {
  garbage_ = 1;
  ViewerNode node(bus_, options_);
  publish_status();
  run(node, 6);
  EXPECT_GE(requests_.size(), 2u);
  EXPECT_GT(colour_pixels(images_.back(), submap_color(SubmapKind::kFront, 0)), 300);
}

TEST_F(ViewerNodeTest, AFolderThatIsNotThereIsReportedAndSurvived) {
  options_.output = folder_ + "/missing";
  ViewerNode node(bus_, options_);
  publish_tracks();
  publish_status();
  run(node, 3);
  EXPECT_TRUE(node.status().degraded);
  EXPECT_THAT(node.status().detail, ::testing::HasSubstr("missing"));
  const size_t before = images_.size();
  EXPECT_GE(before, 1u);
  fs::create_directory(options_.output);
  publish_tracks();
  run(node, 3);
  EXPECT_GT(images_.size(), before);
  EXPECT_FALSE(node.status().degraded);
}

TEST_F(ViewerNodeTest, LinksOfTheStatusAreDrawnAndNonsenseIsSurvived) {
  ViewerNode node(bus_, options_);
  link_t link{};
  link.session_a = link.session_b = 1;
  link.submap_a = 1;
  link.submap_b = 77;  // a submap that does not exist
  link.kind = 99;
  link.accepted = true;
  map_status_t status{};
  status.utime = bus_.now_us();
  status.nlinks = 1;
  status.links = {link};
  bus_.publish(channels::kMapStatus, status);
  track_t track{};
  track.state = 99;
  track.submap_id = -12345;
  track.utime = 5'000'000;
  bus_.publish(channels::kTrack, track);
  track.utime = 1'000'000;  // goes back in time
  bus_.publish(channels::kTrack, track);
  run(node, 3);
  EXPECT_GE(images_.size(), 1u);
  EXPECT_FALSE(node.status().degraded);
}

TEST_F(ViewerNodeTest, ShowsTheLatestKeyframesImageWithItsKeypoints) {
  Keyframe& keyframe = submap_.keyframes.rbegin()->second;
  auto features = std::make_shared<Features>();
  features->keypoints.push_back({.pixel = {320, 240}});
  features->descriptors.resize(1);
  features->undistort(submap_.camera);
  keyframe.features = features;
  keyframe.landmark_ids = {kNone};
  ASSERT_TRUE(submap_.add_observation(5, keyframe.id, 0));
  ViewerNode node(bus_, options_);
  const cv::Mat plain(480, 640, CV_8UC3, cv::Scalar(40, 160, 240));
  bus_.publish(channels::kCamera, make_rgb_image(keyframe.utime_us, plain));
  bus_.dispatch();
  track_t track{};
  track.utime = keyframe.utime_us;
  track.session = 1;
  track.submap_id = 1;
  track.state = track_t::TRACKING;
  track.is_keyframe = true;
  track.cam_from_submap = to_wire(SE3());
  bus_.publish(channels::kTrack, track);
  bus_.dispatch();
  image_t broken = make_rgb_image(keyframe.utime_us + 33'333, plain);
  broken.data.resize(10);
  broken.size = 10;
  bus_.publish(channels::kCamera, broken);
  publish_status();
  run(node, 3);
  ASSERT_GE(images_.size(), 1u);
  EXPECT_GT(colour_pixels(images_.back(), {240, 160, 40}), 50'000);
  const cv::Rect room = layout_all(true).camera;
  const cv::Mat picture = decode_bgr(images_.back()).value();
  const cv::Vec3b mark = picture.at<cv::Vec3b>(room.y + room.height / 2, room.x + room.width / 2);
  EXPECT_LT(mark[2], 120);  // the mark covers the orange image
  // Much later, the keyframe's image is too old to be shown, and the latest image cannot be decoded: no image is shown.
  image_t later = broken;
  later.utime += 10'000'000;
  bus_.publish(channels::kCamera, later);
  publish_tracks();
  run(node, 3);
  EXPECT_EQ(colour_pixels(images_.back(), {240, 160, 40}), 0);
  EXPECT_FALSE(node.status().degraded);
}

TEST_F(ViewerNodeTest, APoseThatWasWithdrawnIsShownAsLost) {
  ViewerNode node(bus_, options_);
  publish_tracks();
  publish_status();
  run(node, 3);
  ASSERT_GE(images_.size(), 1u);
  const int before = colour_pixels(images_.back(), kRecentlyLostColor);
  publish_tracks(track_t::RECENTLY_LOST);
  run(node, 3);
  EXPECT_GT(colour_pixels(images_.back(), kRecentlyLostColor), before + 200);
}

TEST_F(ViewerNodeTest, KeepsASeriesAtItsRate) {
  options_.series = true;
  options_.interval_s = 0.5;
  ViewerNode node(bus_, options_);
  for (int i = 0; i < 4; ++i) {
    publish_tracks();
    publish_status();
    run(node, 0.5);
  }
  node.finish();
  run(node, 3);
  ASSERT_TRUE(node.finished());
  EXPECT_GE(node.pictures(), 4);
  EXPECT_EQ(static_cast<size_t>(node.pictures()), images_.size());
  cv::VideoCapture video(folder_ + "/trajectory.mp4");
  cv::Mat frame;
  int64_t frames = 0;
  while (video.read(frame)) ++frames;
  EXPECT_EQ(frames, node.pictures());
  EXPECT_FALSE(node.status().degraded);
}

TEST_F(ViewerNodeTest, StartedAgainItGoesOnWithItsSeries) {
  options_.series = true;
  std::vector<std::unique_ptr<ViewerNode>> processes;  // dead ones stay on the bus, but do nothing
  const auto pictures_of_a_process = [&](bool ends) {
    ViewerNode& node = *processes.emplace_back(std::make_unique<ViewerNode>(bus_, options_));
    publish_tracks();
    publish_status();
    run(node, 3);
    if (ends) {
      node.finish();
      run(node, 3);
      EXPECT_TRUE(node.finished());
    }
    EXPECT_GT(node.pictures(), 0);
    return node.pictures();
  };
  const auto files = [this] {
    int64_t count = 0;
    for (const auto& entry : fs::directory_iterator(folder_ + "/pictures")) count += entry.path().extension() == ".png";
    return count;
  };
  const int64_t before = pictures_of_a_process(false);
  EXPECT_EQ(files(), before) << "and it died";
  const int64_t after = pictures_of_a_process(true);
  EXPECT_EQ(files(), before + after);
  const int64_t anew = pictures_of_a_process(true);
  EXPECT_EQ(files(), anew) << "a new run";
}

TEST_F(ViewerNodeTest, ASeriesNeedsAFolder) {
  options_.series = true;
  options_.output.clear();
  EXPECT_THROW(ViewerNode(bus_, options_), std::runtime_error);
}

TEST_F(ViewerNodeTest, WithoutOpenGlItSaysSoAndGoesOn) {
  setenv("RUMI_OPENGL", "none", 1);
  ViewerNode node(bus_, options_);
  publish_status();
  run(node, 3);
  unsetenv("RUMI_OPENGL");
  EXPECT_TRUE(node.status().degraded);
  EXPECT_THAT(node.status().detail, ::testing::HasSubstr("RUMI_OPENGL"));
  publish_tracks();
  run(node, 3);
  EXPECT_FALSE(node.status().degraded);
}

}  // namespace
}  // namespace rumi::viewer_offscreen
