// SPDX-License-Identifier: BSD-3-Clause
// Tests the output of front_tracker: poses, also in the map and afterwards, withdrawn poses, and submaps for
// map_server.
#include <gmock/gmock.h>

#include <algorithm>
#include <random>
#include <utility>

#include "bus/wire/pose.h"
#include "lcmtypes/rumi/map_pose_t.hpp"
#include "lcmtypes/rumi/map_status_t.hpp"
#include "lcmtypes/rumi/rigid_transform_t.hpp"
#include "tests/front_tracker/front_tracker_node_fixture.h"
#include "tests/front_tracker/rendered_walk.h"
#include "tests/front_tracker/slip.h"

namespace rumi::front_tracker {
namespace {

using testing::FrontTrackerNodeTest;
using testing::node_options;

// From these messages a listener of CAMERA_TO_MAP can tell that the map has moved.
TEST_F(FrontTrackerNodeTest, APoseInTheMapNamesTheSubmapAndItsPlace) {
  std::vector<map_pose_t> poses;
  std::vector<rigid_transform_t> transforms;
  bus_.subscribe<map_pose_t>(channels::kMapPose, {}, [&](const map_pose_t& p) { poses.push_back(p); });
  bus_.subscribe<rigid_transform_t>(channels::kCameraToMap, {}, [&](const auto& t) { transforms.push_back(t); });
  synth::SequenceRenderer renderer(walk(1.5));
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

FrontTrackerOptions small_submaps() {
  FrontTrackerOptions options = node_options();
  options.mapping.submap_keyframes = 8;
  options.mapping.bundle_keyframes = options.mapping.bundle_fixed_keyframes = 3;
  return options;
}
class SmallSubmapsTest : public FrontTrackerNodeTest {
 protected:
  SmallSubmapsTest() : FrontTrackerNodeTest(small_submaps()) {}
};

// map_server places a new submap seconds after it began. Until then it lies where the one lies that it goes on from.
TEST_F(SmallSubmapsTest, APoseInTheMapIsToldWhereASubmapGoesOnFromAPlacedOne) {
  std::vector<map_pose_t> poses;
  bus_.subscribe<map_pose_t>(channels::kMapPose, {}, [&](const map_pose_t& p) { poses.push_back(p); });
  synth::SequenceRenderer renderer(walk(4));
  for (int i = 0; i < renderer.frames(); ++i) {
    give(image(renderer.utime_us(i), renderer.render(i)));
    if (tracks_.back().submap_id != 1) continue;
    map_status_t status{};
    status.map_revision = status.front_submaps = status.submaps_in_map = status.nsubmaps = 1;
    status.submaps.resize(1);
    status.submaps[0].session = tracks_.back().session;
    status.submaps[0].submap_id = 1;
    status.submaps[0].in_map = true;
    status.submaps[0].map_from_submap = to_wire(Sim3());
    bus_.publish(channels::kMapStatus, status);
    bus_.dispatch();
  }
  ASSERT_GE(node_->tracker()->submaps().size(), 3U);
  EXPECT_EQ(poses.back().utime, tracks_.back().utime) << "the last image has a pose in the map";
  EXPECT_EQ(poses.back().submap_id, tracks_.back().submap_id);
  EXPECT_GE(poses.back().submap_id, 3);
}

TEST_F(FrontTrackerNodeTest, TheServersCopyIsComplete) {
  std::mt19937 rng(3);
  // The bus loses a fifth of the messages between front_tracker and the server.
  bus_.set_tap([&rng](const std::string& channel, auto) {
    return (channel != channels::kSubmap && channel != channels::kSubmapAck) || rng() % 5 != 0;
  });
  give_walk(2.5);
  ASSERT_FALSE(node_->tracker()->submaps().empty());
  const Submap made = node_->tracker()->submaps()[0]->map;
  node_->finish();
  EXPECT_EQ(node_->waits_for(), "map_server has not taken the last of the submaps");
  give_it_time_to_finish();
  ASSERT_TRUE(node_->finished());
  EXPECT_TRUE(node_->complaints().empty());
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

// Every mapping job throws while it holds the submap's lock.
class BrokenMapping : public FrontTrackerNodeTest {
 protected:
  static FrontTrackerOptions options(bool threaded) {
    FrontTrackerOptions options = node_options();
    options.mapping_thread = threaded;
    options.mapping.bundle_fixed_keyframes = -1;
    return options;
  }
  explicit BrokenMapping(bool threaded = false) : FrontTrackerNodeTest(options(threaded)) {}

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
    // The lock is free again, and the submaps pass the receiver's checks.
    node_->finish();
    give_it_time_to_finish();
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

TEST_F(FrontTrackerNodeTest, PosesGivenAfterwardsAreToldBeforeTheFrameThatBeganTheSubmap) {
  give_walk(2);
  ASSERT_EQ(node_->tracker()->submaps().size(), 1u);
  std::map<int64_t, std::vector<track_t>> told;  // messages by utime
  std::vector<int64_t> late;                     // utimes in order of arrival
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

TEST_F(FrontTrackerNodeTest, WithdrawnPosesAreToldBeforeTheFrameThatContradictsThem) {
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
  give_it_time_to_finish();
  ASSERT_EQ(copies_.size(), 1u);
  EXPECT_EQ(copies_.begin()->second.frames.size(), made.frames.size()) << "the server has forgotten them too";
}

}  // namespace
}  // namespace rumi::front_tracker
