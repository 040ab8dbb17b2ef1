// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/front_tracker_node.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <utility>

#include "base/exit_codes.h"
#include "bus/transport/memory_bus.h"
#include "bus/wire/camera_file.h"
#include "bus/wire/image_codec.h"
#include "bus/wire/image_stream.h"
#include "bus/wire/jpeg_image.h"
#include "bus/wire/submap_update.h"
#include "lcmtypes/rumi/map_pose_t.hpp"
#include "lcmtypes/rumi/map_request_t.hpp"
#include "lcmtypes/rumi/map_status_t.hpp"
#include "lcmtypes/rumi/rigid_transform_t.hpp"
#include "lcmtypes/rumi/track_t.hpp"
#include "rumi/synth/sequence_renderer.h"
#include "tests/front_tracker/rendered_walk.h"
#include "tests/front_tracker/slip.h"
#include "tests/support/captured_log.h"

namespace rumi::front_tracker {
namespace {

using ::testing::HasSubstr;

FrontTrackerOptions fixture_options() {
  FrontTrackerOptions options;
  options.mapping_thread = false;
  options.mapping.keyframe_images = 5;  // fewer than there are keyframes: their keypoints are sent twice
  return options;
}

// A front_tracker on a bus, with a stand-in for map_server that applies every update.
class Fixture : public ::testing::Test {
 protected:
  explicit Fixture(const FrontTrackerOptions& options = fixture_options())
      : receiver_(bus_, channels::kSubmap, channels::kSubmapAck, "server", true,
                  [this](const auto& p) { return store(p); }) {
    node_ = std::make_unique<FrontTrackerNode>(bus_, options);
    bus_.subscribe<track_t>(channels::kTrack, {}, [this](const track_t& t) { tracks_.push_back(t); });
  }

  ChunkReceiver::Verdict store(const ChunkReceiver::Payload& payload) {
    submap_update_t update;
    EXPECT_TRUE(Bus::decode(std::span<const uint8_t>(payload.bytes), &update));
    Submap& copy = copies_[{update.session, update.submap_id}];
    const std::string error = apply_submap_update(update, &copy);
    EXPECT_EQ(error, "");
    return {error.empty(), error, copy.revision};
  }

  image_t image(int64_t utime_us, const cv::Mat& grey, bool calibrated = true) {
    image_t message = make_jpeg_image(utime_us, grey);
    if (calibrated) set_metadata(&message, kCalibrationKey, camera_to_yaml(camera_));
    return message;
  }

  tool::SynthOptions walk(double seconds) const {
    tool::SynthOptions options;
    options.seconds = seconds;
    options.rate_hz = 20;
    options.grey = true;
    options.camera = camera_;
    options.exposure_s = 0;
    return options;
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
  Camera camera_ = tool::default_synth_camera(320, 240);
  const cv::Mat grey_ = cv::Mat(240, 320, CV_8U, cv::Scalar(99));
};

TEST_F(Fixture, AnImageWithoutCalibrationSaysWhatToDo) {
  give(image(1000, grey_, false));
  EXPECT_TRUE(tracks_.empty());
  const NodeStatus status = node_->status();
  EXPECT_TRUE(status.degraded);
  EXPECT_NE(status.detail.find("--camera FILE"), std::string::npos) << status.detail;
  give(image(2000, grey_));
  EXPECT_EQ(tracks_.size(), 1u) << "it goes on as soon as there is one";
  EXPECT_FALSE(node_->status().degraded);
}

TEST_F(Fixture, SaysOnceThatNoImageComes) {
  bus_.set_now_us(1'000'000);
  FrontTrackerNode node(bus_, fixture_options());
  const testing::CapturedLog log;
  node.tick(10'900'000);
  EXPECT_EQ(log.text(), "");
  node.tick(11'000'000);
  EXPECT_THAT(log.text(), HasSubstr("no image has come for 10 s"));
  const std::string once = log.text();
  node.tick(60'000'000);
  EXPECT_EQ(log.text(), once);
}

TEST_F(Fixture, SaysThatWhatComesOnTheCamerasChannelIsNoImage) {
  MemoryBus bus;
  bus.set_now_us(1'000'000);
  FrontTrackerNode node(bus, fixture_options());
  bus.publish(channels::kCamera, map_request_t());
  bus.dispatch();
  const testing::CapturedLog log;
  node.tick(11'000'000);
  EXPECT_THAT(log.text(), HasSubstr("1 messages came on the camera's channel, and none is an image_t"));
}

TEST_F(Fixture, ImagesOfWhichNoneGetsAPoseAreNotAll) {
  EXPECT_EQ(node_->exit_code(), 0) << "nothing came";
  give(image(1000, grey_));
  EXPECT_EQ(node_->exit_code(), kNotAll);
}

TEST_F(Fixture, ImagesOfAnotherSizeAreRefusedByNameOfBothSizes) {
  give(image(1000, cv::Mat(480, 640, CV_8U, cv::Scalar(9))));
  EXPECT_NE(node_->status().detail.find("640x480"), std::string::npos);
  EXPECT_NE(node_->status().detail.find("320x240"), std::string::npos);
  give(image(2000, grey_));
  give(image(3000, cv::Mat(100, 100, CV_8U, cv::Scalar(9))));
  give(image(4000, grey_));
  ASSERT_EQ(tracks_.size(), 2u);
  EXPECT_EQ(tracks_[0].utime, 2000);
  EXPECT_EQ(tracks_[1].utime, 4000);
}

TEST_F(Fixture, DamagedImagesAreCountedAndPassedOver) {
  give(image(1000, grey_));
  image_t damaged = image(2000, grey_);
  damaged.data.resize(damaged.data.size() / 2);
  damaged.size = static_cast<int32_t>(damaged.data.size());
  give(damaged);
  image_t lying = make_grey_image(3000, grey_);
  lying.width = 100000;
  give(lying);
  give(image(4000, grey_));
  EXPECT_EQ(tracks_.size(), 2u);
  EXPECT_NE(node_->status().detail.find("2 images refused: image"), std::string::npos) << node_->status().detail;
}

TEST_F(Fixture, AnImageThatCannotBeUsedBeginsNoSession) {
  const cv::Mat large(480, 640, CV_8U, cv::Scalar(9));
  give(image(1000, large));  // calibrated for another size, until somebody puts that right
  EXPECT_FALSE(node_->tracker());
  camera_ = tool::default_synth_camera(640, 480);
  give(image(2000, large));
  ASSERT_EQ(tracks_.size(), 1u);
  EXPECT_EQ(node_->tracker()->camera().width, 640);
}

TEST_F(Fixture, LargeImagesAreWorkedOnSmaller) {
  MemoryBus bus;
  FrontTrackerOptions options;
  options.mapping_thread = false;
  options.max_image_side = 160;
  FrontTrackerNode node(bus, options);
  bus.publish(channels::kCamera, image(1000, grey_));
  bus.dispatch();
  ASSERT_TRUE(node.tracker());
  EXPECT_EQ(node.tracker()->camera().width, 160);
  EXPECT_EQ(node.tracker()->camera().height, 120);
  EXPECT_FALSE(node.status().degraded) << node.status().detail;
}

TEST_F(Fixture, BadCalibrationNamesFieldAndValue) {
  camera_.fx = std::numeric_limits<double>::quiet_NaN();
  give(image(1000, grey_));
  EXPECT_TRUE(tracks_.empty());
  EXPECT_NE(node_->status().detail.find("fx"), std::string::npos) << node_->status().detail;
}

TEST_F(Fixture, OldImagesAreRefusedAndARestartedRecordingIsANewSession) {
  for (int i = 0; i < 20; ++i) give(image(1'000'000 + 1000 * i, grey_));
  ASSERT_EQ(tracks_.size(), 20u);
  give(image(1'005'000, grey_));
  EXPECT_EQ(tracks_.size(), 20u) << "one image out of order";
  give(image(1'030'000, grey_));
  ASSERT_EQ(tracks_.size(), 21u);
  for (int i = 0; i < 20; ++i) give(image(5000 + 1000 * i, grey_));
  EXPECT_GT(tracks_.back().session, tracks_.front().session);
  EXPECT_EQ(tracks_.back().utime, 24'000);
  EXPECT_EQ(tracks_.size(), 21u + 20u) << "the images that waited for the decision are the first of the session";
  for (size_t i = 1; i < tracks_.size(); ++i)
    EXPECT_EQ(tracks_[i].sequence, tracks_[i].session == tracks_[i - 1].session ? tracks_[i - 1].sequence + 1 : 0);
}

TEST_F(Fixture, ASecondCameraOnTheChannelIsToldAndKeptApart) {
  const Camera own = camera_;
  const auto other_camera = [&] { camera_.fx = own.fx * 1.1; };
  for (int i = 0; i < 40; ++i) {
    camera_ = own;
    if (i % 2 == 1) other_camera();
    give(image(1'000'000 + 1000 * i, grey_));
  }
  ASSERT_EQ(tracks_.size(), 20u);
  for (const track_t& track : tracks_) EXPECT_EQ(track.utime / 1000 % 2, 0) << "one of the second camera";
  EXPECT_EQ(tracks_.back().session, tracks_.front().session);
  const std::string detail = node_->status().detail;
  EXPECT_NE(detail.find("20 images refused: another camera"), std::string::npos) << detail;
}

TEST_F(Fixture, ACameraThatIsChangedBeginsANewSession) {
  for (int i = 0; i < 5; ++i) give(image(1'000'000 + 1000 * i, grey_));
  camera_.fx *= 1.1;
  for (int i = 5; i < 30; ++i) give(image(1'000'000 + 1000 * i, grey_));
  ASSERT_EQ(tracks_.size(), 30u);
  EXPECT_NE(tracks_.back().session, tracks_.front().session);
  EXPECT_EQ(node_->tracker()->camera().fx, camera_.fx);
}

TEST_F(Fixture, ASecondStreamOfTheSameCalibrationIsToldAndKeptApart) {
  for (int i = 0; i < 40; ++i) {
    image_t message = image(1'000'000 + 1000 * i, grey_);
    set_stream(i % 2 == 0 ? 5 : 6, &message);
    give(message);
  }
  ASSERT_EQ(tracks_.size(), 20u);
  for (const track_t& track : tracks_) EXPECT_TRUE(track.utime / 1000 % 2 == 0 && track.stream == 5);
  const std::string detail = node_->status().detail;
  EXPECT_NE(detail.find("20 images refused: another camera"), std::string::npos) << detail;
}

TEST_F(Fixture, AnotherRecordingIsAnotherSessionWhateverItsTimes) {
  for (const int64_t stream : {5, 6}) {  // of the same times, as folders of images are
    for (int i = 0; i < 30; ++i) {
      image_t message = image(1000 * i, grey_);
      set_stream(stream, &message);
      give(message);
    }
  }
  EXPECT_EQ(tracks_.front().stream, 5);
  EXPECT_EQ(tracks_.back().stream, 6);
  EXPECT_GT(tracks_.back().session, tracks_.front().session);
  EXPECT_EQ(tracks_.size(), 60u);
}

TEST_F(Fixture, ImagesWithoutANameAreOfTheirSessionsStream) {
  for (int i = 0; i < 20; ++i) give(image(1'000'000 + 1000 * i, grey_));
  for (int i = 0; i < 20; ++i) give(image(1000 * i, grey_));
  EXPECT_EQ(tracks_.front().stream, tracks_.front().session);
  EXPECT_EQ(tracks_.back().stream, tracks_.back().session);
  EXPECT_NE(tracks_.back().stream, tracks_.front().stream);
}

TEST_F(Fixture, SessionsBeginAfterThoseOfTheMapThatTheyComeInto) {
  node_->begin_sessions_after(9'000'000'000);
  give(image(1000, grey_));
  EXPECT_EQ(tracks_.front().session, 9'000'000'001);
}

TEST_F(Fixture, ACameraFileThatIsNoGoodStopsItAtTheStart) {
  FrontTrackerOptions options;
  options.camera_file = "/nonexistent/camera.yaml";
  EXPECT_THROW(FrontTrackerNode(bus_, options), std::runtime_error);
}

// What a listener of CAMERA_TO_MAP needs to know to notice that the map has moved.
TEST_F(Fixture, APoseInTheMapNamesTheSubmapAndItsPlace) {
  std::vector<map_pose_t> poses;
  std::vector<rigid_transform_t> transforms;
  bus_.subscribe<map_pose_t>(channels::kMapPose, {}, [&](const map_pose_t& p) { poses.push_back(p); });
  bus_.subscribe<rigid_transform_t>(channels::kCameraToMap, {}, [&](const auto& t) { transforms.push_back(t); });
  tool::SequenceRenderer renderer(walk(1.5));
  const Sim3 map_from_submap(2, Eigen::Quaterniond::Identity(), Eigen::Vector3d(1, 2, 3));
  for (int i = 0; i < renderer.frames(); ++i) {
    give(image(renderer.utime_us(i), renderer.render(i)));
    const track_t& track = tracks_.back();
    if (track.submap_id == kNoSubmap || i % 5 != 0) continue;
    map_status_t status{};
    status.map_revision = 100 + i;
    status.front_submaps = status.submaps_in_map = status.nsubmaps = 1;
    status.submaps.resize(1);
    status.submaps[0].session = track.session;
    status.submaps[0].submap_id = track.submap_id;
    status.submaps[0].in_map = true;
    status.submaps[0].placement_revision = i;
    status.submaps[0].map_from_submap = to_wire(map_from_submap);
    bus_.publish(channels::kMapStatus, status);
    bus_.dispatch();
  }
  ASSERT_GE(poses.size(), 5u);
  ASSERT_EQ(transforms.size(), poses.size());
  EXPECT_EQ(transforms.back().utime, poses.back().utime);
  EXPECT_EQ(transforms.back().trans[0], poses.back().map_from_cam.trans[0]);
  EXPECT_EQ(poses.back().session, tracks_.back().session);
  EXPECT_EQ(poses.back().submap_id, tracks_.back().submap_id);
  EXPECT_EQ(poses.back().map_revision, poses.back().placement_revision + 100);
  EXPECT_GT(poses.back().placement_revision, poses.front().placement_revision);
  EXPECT_FLOAT_EQ(poses.back().position_sigma, 2 * tracks_.back().position_sigma);
}

TEST_F(Fixture, TheServersCopyIsComplete) {
  tool::SequenceRenderer renderer(walk(2.5));
  std::mt19937 rng(3);
  // A bus that loses a fifth of what passes between the two.
  bus_.set_tap([&rng](const std::string& channel, auto) {
    return (channel != channels::kSubmap && channel != channels::kSubmapAck) || rng() % 5 != 0;
  });
  for (int i = 0; i < renderer.frames(); ++i) give(image(renderer.utime_us(i), renderer.render(i)));
  ASSERT_FALSE(node_->tracker()->submaps().empty());
  const Submap made = node_->tracker()->submaps()[0]->map;
  node_->finish();
  EXPECT_EQ(node_->waits_for(), "map_server has not taken the last of the submaps");
  for (int i = 0; i < 500 && !node_->finished(); ++i) {
    bus_.set_now_us(bus_.now_us() + 100'000);
    tick();
  }
  ASSERT_TRUE(node_->finished());
  EXPECT_EQ(node_->exit_code(), 0);
  ASSERT_EQ(copies_.size(), 1u);
  const Submap& copy = copies_.begin()->second;
  EXPECT_TRUE(copy.closed);
  ASSERT_EQ(copy.keyframes.size(), made.keyframes.size());
  ASSERT_EQ(copy.landmarks.size(), made.landmarks.size());
  ASSERT_EQ(copy.frames.size(), made.frames.size());
  for (const auto& [id, kf] : made.keyframes) {
    EXPECT_EQ(copy.keyframe(id)->cam_from_submap.translation, kf.cam_from_submap.translation);
    EXPECT_EQ(copy.keyframe(id)->landmark_ids, kf.landmark_ids);
    EXPECT_EQ(copy.keyframe(id)->features->descriptors, kf.features->descriptors);
    for (size_t i = 0; i < kf.features->size(); ++i)
      ASSERT_EQ(copy.keyframe(id)->features->keypoints[i].pixel, kf.features->keypoints[i].pixel)
          << "keypoint " << i << " of keyframe " << id << ", which may have been moved after it was sent first";
  }
  for (const auto& [id, lm] : made.landmarks) {
    EXPECT_EQ(copy.landmark(id)->position, lm.position);
    EXPECT_EQ(copy.landmark(id)->observations.size(), lm.observations.size());
  }
  int64_t with_pose = 0;
  for (const track_t& t : tracks_) with_pose += t.submap_id != kNoSubmap;
  EXPECT_GE(static_cast<int64_t>(copy.frames.size()), with_pose);
}

// Every mapping job throws, with the submap in its hands.
class BrokenMapping : public Fixture {
 protected:
  static FrontTrackerOptions options(bool threaded) {
    FrontTrackerOptions options = fixture_options();
    options.mapping_thread = threaded;
    options.mapping.bundle_fixed_keyframes = -1;
    return options;
  }
  explicit BrokenMapping(bool threaded = false) : Fixture(options(threaded)) {}

  void expect_to_go_on() {
    const testing::RenderedWalk& walk = testing::rendered_walk();
    camera_ = walk.camera;
    for (size_t i = 0; i < 50; ++i) {
      give(image(walk.utime_us[i], walk.images[i]));
      node_->tracker()->wait_for_mapping();
    }
    ASSERT_EQ(tracks_.back().utime, walk.utime_us[49]);
    EXPECT_EQ(tracks_.back().state, track_t::TRACKING);
    tick();
    NodeStatus status = node_->status();
    EXPECT_TRUE(status.degraded);
    EXPECT_NE(status.detail.find("mapping of a keyframe broke off ("), std::string::npos) << status.detail;
    tick();
    status = node_->status();
    EXPECT_FALSE(status.degraded) << "it did not happen since";
    EXPECT_NE(status.detail.find("mapping of a keyframe broke off ("), std::string::npos) << status.detail;
    // The lock is free, and who checks the submaps finds nothing wrong with them.
    node_->finish();
    for (int i = 0; i < 500 && !node_->finished(); ++i) {
      bus_.set_now_us(bus_.now_us() + 100'000);
      tick();
    }
    EXPECT_TRUE(node_->finished());
    ASSERT_GE(copies_.size(), 1u);
    EXPECT_GT(copies_.begin()->second.keyframes.size(), 1u);
  }
};

TEST_F(BrokenMapping, TheTrackerGoesOn) { expect_to_go_on(); }

class BrokenMappingInAThread : public BrokenMapping {
 protected:
  BrokenMappingInAThread() : BrokenMapping(true) {}
};

TEST_F(BrokenMappingInAThread, TheTrackerGoesOn) { expect_to_go_on(); }

TEST_F(Fixture, PosesGivenAfterwardsAreToldBeforeTheFrameThatBeganTheSubmap) {
  tool::SequenceRenderer renderer(walk(2));
  for (int i = 0; i < renderer.frames(); ++i) give(image(renderer.utime_us(i), renderer.render(i)));
  ASSERT_EQ(node_->tracker()->submaps().size(), 1u);
  std::map<int64_t, std::vector<track_t>> told;  // by utime
  std::vector<int64_t> late;                     // in order of arrival
  int64_t began = 0;
  for (const track_t& t : tracks_) {
    if (!told[t.utime].empty()) late.push_back(t.utime);
    told[t.utime].push_back(t);
    if (began == 0 && t.state == track_t::TRACKING) began = t.utime;
  }
  ASSERT_FALSE(late.empty());
  EXPECT_TRUE(std::is_sorted(late.begin(), late.end()));
  EXPECT_LT(late.back(), began);
  int keyframes = 0;
  for (const auto& [utime, messages] : told) {
    ASSERT_LE(messages.size(), 2u);
    const track_t& first = messages.front();
    const track_t& last = messages.back();
    EXPECT_EQ(first.submap_id != kNoSubmap, utime >= began);
    EXPECT_EQ(last.sequence, first.sequence);
    EXPECT_EQ(last.state, first.state);
    EXPECT_EQ(last.submap_id, 1) << "all frames get poses here";
    ASSERT_TRUE(from_wire(last.cam_from_submap));
    ASSERT_TRUE(from_wire(last.cam_from_keyframe));
    EXPECT_EQ(sigmas_of(first).are_known(), utime >= began);
    const PoseSigmas sigmas = sigmas_of(last);
    EXPECT_GT(sigmas.position, 1e-5);
    EXPECT_LT(sigmas.position, 0.1) << "in the submap, whose unit is its first baseline";
    EXPECT_LT(sigmas.rotation_rad, 0.05);
    EXPECT_LT(sigmas.log_scale, 0.1);
    EXPECT_EQ(node_->tracker()->submaps()[0]->map.frame(utime)->sigmas, sigmas) << "as the map has it";
    if (utime < began) keyframes += last.is_keyframe;
  }
  EXPECT_GE(keyframes, 1);
  const auto position = [this](int64_t utime) {
    return std::find_if(tracks_.begin(), tracks_.end(), [&](const track_t& t) { return t.utime == utime; });
  };
  EXPECT_EQ((position(began) - 1)->utime, late.back()) << "just before it";
}

TEST_F(Fixture, WithdrawnPosesAreToldBeforeTheFrameThatContradictsThem) {
  const testing::RenderedWalk& walk = testing::rendered_walk();
  const size_t slipped = 77, lost = 100, back = 72;
  const cv::Mat black(walk.images[0].size(), CV_8U, cv::Scalar(0));
  for (size_t i = 0; i < lost; ++i) {
    cv::Mat grey = walk.images[i].clone();
    if (i >= slipped && i < slipped + 3) grey.colRange(0, 3 * grey.cols / 4).setTo(0);
    give(image(walk.utime_us[i], grey));
  }
  ASSERT_EQ(node_->tracker()->submaps().size(), 1u);
  testing::slip(node_->tracker()->submaps()[0].get(), walk.utime_us[slipped]);
  int64_t utime_us = walk.utime_us[lost];
  for (int i = 0; i < 25; ++i) give(image(utime_us += 50'000, black));
  const std::vector<track_t> before = std::exchange(tracks_, {});
  give(image(utime_us += 50'000, walk.images[back]));
  const std::vector<int64_t>& withdrawn = node_->tracker()->withdrawn();
  ASSERT_GE(withdrawn.size(), 10u);
  ASSERT_EQ(tracks_.size(), withdrawn.size() + 1);
  for (size_t i = 0; i < withdrawn.size(); ++i) {
    const track_t& now = tracks_[i];
    const auto told =
        std::find_if(before.rbegin(), before.rend(), [&](const track_t& t) { return t.utime == now.utime; });
    EXPECT_EQ(now.utime, withdrawn[i]);
    EXPECT_EQ(now.sequence, told->sequence);
    EXPECT_EQ(now.session, told->session);
    EXPECT_EQ(now.state, track_t::RECENTLY_LOST);
    EXPECT_EQ(now.submap_id, kNoSubmap);
    EXPECT_EQ(now.reference_keyframe, kNone);
    EXPECT_TRUE(sigmas_of(*told).are_known());
    EXPECT_FALSE(sigmas_of(now).are_known());
    EXPECT_FALSE(now.is_keyframe);
  }
  EXPECT_EQ(tracks_.back().state, track_t::TRACKING);
  const Submap made = node_->tracker()->submaps()[0]->map;
  node_->finish();
  for (int i = 0; i < 500 && !node_->finished(); ++i) {
    bus_.set_now_us(bus_.now_us() + 100'000);
    tick();
  }
  ASSERT_EQ(copies_.size(), 1u);
  EXPECT_EQ(copies_.begin()->second.frames.size(), made.frames.size()) << "the server has forgotten them too";
}

TEST_F(Fixture, GarbageOnItsChannelsDoesNoHarm) {
  give(image(1000, grey_));
  std::mt19937 rng(9);
  const std::vector<uint8_t> real = encode_message(image(2000, grey_));
  for (int i = 0; i < 10'000; ++i) {
    std::vector<uint8_t> bytes;
    if (i % 3 == 0) {
      bytes.resize(rng() % 300);
      for (uint8_t& b : bytes) b = static_cast<uint8_t>(rng());
    } else {
      bytes = real;
      if (i % 3 == 1) bytes.resize(rng() % bytes.size());
      for (int k = 0; k < 5 && !bytes.empty(); ++k)
        bytes[rng() % bytes.size()] ^= static_cast<uint8_t>(1u << rng() % 8);
    }
    bus_.publish_raw(i % 2 ? channels::kCamera : channels::kMapStatus, bytes);
    bus_.publish_raw(channels::kSubmapAck, bytes);
    bus_.dispatch();
  }
  const size_t before = tracks_.size();
  give(image(int64_t{1} << 62, grey_));
  EXPECT_GE(tracks_.size(), before);
  EXPECT_FALSE(node_->status().detail.empty());
}

}  // namespace
}  // namespace rumi::front_tracker
