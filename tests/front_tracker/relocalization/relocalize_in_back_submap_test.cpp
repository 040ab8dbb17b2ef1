// SPDX-License-Identifier: BSD-3-Clause
// The tracker is lost, comes back to a place that only rumination has rebuilt, and goes on there.
#include <gtest/gtest.h>

#include "bus/transport/memory_bus.h"
#include "bus/wire/calibration.h"
#include "bus/wire/image_codec.h"
#include "bus/wire/pose.h"
#include "bus/wire/submap_update.h"
#include "front_tracker/front_tracker_node.h"
#include "lcmtypes/rumi/map_request_t.hpp"
#include "tests/front_tracker/rendered_walk.h"

namespace rumi::front_tracker {
namespace {

using testing::render_walk;
using testing::rendered_walk;
using testing::RenderedWalk;
using testing::replay_options;

constexpr size_t kGapBegin = 60, kGapEnd = 120;  // images of the walk that only rumination sees
constexpr size_t kBackFrom = 72;                 // first image after the return
constexpr int64_t kLaterUs = 20'000'000;

// Returns what rumination would make of the gap, in a unit of its own: keyframes without the frames between.
Submap rebuilt(const RenderedWalk& walk) {
  Tracker tracker(walk.camera, replay_options(), 1);
  for (size_t i = kGapBegin; i < kGapEnd; ++i) tracker.process(walk.utime_us[i], walk.images[i]);
  EXPECT_EQ(tracker.submaps().size(), 1u);
  Submap submap = tracker.submaps()[0]->map;
  submap.key = {1, -1};
  submap.kind = SubmapKind::kBack;
  submap.closed = true;
  submap.frames = {};
  for (auto& [id, kf] : submap.keyframes) {
    kf.cam_from_submap.translation *= 3;
    submap.frames.set({kf.utime_us, id, SE3(), 1});
  }
  for (auto& [id, lm] : submap.landmarks) lm.position *= 3;
  return submap;
}

// A tracker that has seen the first images, and then nothing for 1.5 s.
class ReturnToTheGap : public ::testing::Test {
 protected:
  ReturnToTheGap() : tracker_(rendered_walk().camera, replay_options(), 1) {
    const RenderedWalk& walk = rendered_walk();
    for (size_t i = 0; i < 30; ++i) tracker_.process(walk.utime_us[i], walk.images[i]);
    const cv::Mat black(walk.images[0].size(), CV_8U, cv::Scalar(0));
    for (int i = 0; i < 30; ++i) last_ = tracker_.process(walk.utime_us[kGapBegin] + 50'000 * i, black);
  }
  TrackResult come_back(size_t i) {
    const RenderedWalk& walk = rendered_walk();
    const auto result = tracker_.process(walk.utime_us[i] + kLaterUs, walk.images[i]);
    EXPECT_TRUE(result);
    return *result;
  }
  Tracker tracker_;
  std::optional<TrackResult> last_;
};

TEST_F(ReturnToTheGap, GoesOnInACopyOfTheBackSubmap) {
  ASSERT_EQ(last_->state, TrackingState::kLost);
  const Submap back = rebuilt(rendered_walk());
  ASSERT_EQ(tracker_.add_back_submap(back).error_text(), "");
  ASSERT_EQ(tracker_.back_submaps().submaps(), 1u);
  auto center = rendered_walk().center;
  for (size_t i = kBackFrom; i < kGapEnd - 10; ++i) {
    const TrackResult r = come_back(i);
    ASSERT_EQ(r.state, TrackingState::kTracking) << "image " << i;
    ASSERT_EQ(r.submap_id, 2);
    EXPECT_TRUE(tracker_.posed_afterwards().empty()) << "nothing was begun anew";
    center[r.utime_us] = center.at(rendered_walk().utime_us[i]);
  }
  ASSERT_EQ(tracker_.submaps().size(), 2u);
  const Submap& seeded = tracker_.submaps()[1]->map;
  EXPECT_EQ(seeded.key, (SubmapKey{1, 2}));
  EXPECT_EQ(seeded.kind, SubmapKind::kFront);
  EXPECT_EQ(tracker_.back_submaps().submaps(), 0u);
  const testing::Error error = testing::error_of(seeded, center);
  EXPECT_EQ(error.frames, back.keyframes.size() + kGapEnd - 10 - kBackFrom);
  EXPECT_LT(error.rmse_m, 0.02);
  EXPECT_LT(error.worst_m, 0.06);
  // The copy keeps the back submap's images, by which map_server joins the two, and its unit.
  size_t same = 0;
  for (const auto& [id, kf] : back.keyframes) same += seeded.frame(kf.utime_us) != nullptr;
  EXPECT_EQ(same, back.keyframes.size());
  const auto span = [](const Submap& s, int64_t from, int64_t to) {
    return (s.cam_from_submap(*s.frame(from)).center() - s.cam_from_submap(*s.frame(to)).center()).norm();
  };
  const int64_t from = back.frames.begin()->first, to = back.frames.rbegin()->first;
  EXPECT_NEAR(span(seeded, from, to) / span(back, from, to), 1, 0.05);
}

TEST_F(ReturnToTheGap, WithoutTheBackSubmapThePlaceIsUnknown) {
  EXPECT_NE(come_back(kBackFrom).state, TrackingState::kTracking);
}

TEST(BackSubmapOfTheGap, NearlyEveryOtherViewOfItIsFoundWhereItIs) {
  const RenderedWalk& walk = rendered_walk();
  const Submap submap = rebuilt(walk);
  std::vector<Eigen::Vector3d> estimated, truth;
  for (const auto& [id, kf] : submap.keyframes) {
    estimated.push_back(kf.cam_from_submap.center());
    truth.push_back(walk.center.at(kf.utime_us));
  }
  const auto room_from_submap = umeyama(estimated, truth);
  ASSERT_TRUE(room_from_submap);
  const FrontTrackerOptions options = replay_options();
  BackSubmaps back(walk.camera, options.tracking, options.orb.pyramid);
  ASSERT_EQ(back.add(submap).error_text(), "");
  OrbExtractor extractor(options.orb);
  int tried = 0, found = 0;
  for (size_t i = kGapBegin; i < kGapEnd; ++i) {
    if (submap.frame(walk.utime_us[i])) continue;  // this image is in the submap, so finding it proves nothing
    const Frame frame = make_frame(walk.utime_us[i], extractor.extract(walk.images[i]), walk.camera);
    BackSubmaps untouched = back;
    ++tried;
    const auto relocalized = untouched.relocalize(frame);
    if (!relocalized) continue;
    ++found;
    const Eigen::Vector3d center = *room_from_submap * relocalized->frame.cam_from_submap.center();
    EXPECT_LT((center - walk.center.at(walk.utime_us[i])).norm(), 0.05) << "image " << i;
  }
  EXPECT_GE(tried, 30);
  EXPECT_GE(found, 0.95 * tried) << "of " << tried;
}

TEST_F(ReturnToTheGap, AnotherRoomIsNotTakenForThisOne) {
  ASSERT_EQ(tracker_.add_back_submap(rebuilt(render_walk(6, 20, 5))).error_text(), "");
  for (size_t i = kBackFrom; i < kBackFrom + 3; ++i) EXPECT_EQ(come_back(i).submap_id, kNoSubmap);
  EXPECT_EQ(tracker_.back_submaps().submaps(), 1u);
}

TEST_F(ReturnToTheGap, WhatTheFrontSawItFindsInItsOwnSubmap) {
  ASSERT_EQ(tracker_.add_back_submap(rebuilt(rendered_walk())).error_text(), "");
  EXPECT_EQ(come_back(20).submap_id, 1);
  EXPECT_EQ(tracker_.back_submaps().submaps(), 1u);
}

// Taking a back submap would begin a new submap. Just after a loss, the old one may still be found again.
TEST(RecentlyLost, NoBackSubmapIsTaken) {
  const RenderedWalk& walk = rendered_walk();
  const FrontTrackerOptions options = replay_options();
  Tracker tracker(walk.camera, options, 1);
  for (size_t i = 0; i < 30; ++i) tracker.process(walk.utime_us[i], walk.images[i]);
  ASSERT_EQ(tracker.add_back_submap(rebuilt(walk)).error_text(), "");
  const int64_t lost_us = walk.utime_us[30];
  tracker.process(lost_us, cv::Mat(walk.images[0].size(), CV_8U, cv::Scalar(0)));
  for (int64_t later_us = 100'000; later_us <= 1'200'000; later_us += 100'000) {
    const auto result = tracker.process(lost_us + later_us, walk.images[kBackFrom + later_us / 100'000]);
    const bool recently = 1e-6 * static_cast<double>(later_us) <= options.tracking.recently_lost_s;
    EXPECT_EQ(result->state, recently ? TrackingState::kRecentlyLost : TrackingState::kTracking) << later_us;
    EXPECT_EQ(result->submap_id, recently ? kNoSubmap : 2);
  }
}

TEST_F(ReturnToTheGap, RepeatsItself) {
  const Submap back = rebuilt(rendered_walk());
  const auto run = [&] {
    Tracker tracker(rendered_walk().camera, replay_options(), 1);
    for (size_t i = 0; i < 30; ++i) tracker.process(rendered_walk().utime_us[i], rendered_walk().images[i]);
    const cv::Mat black(rendered_walk().images[0].size(), CV_8U, cv::Scalar(0));
    tracker.process(rendered_walk().utime_us[kGapBegin], black);
    EXPECT_EQ(tracker.add_back_submap(back).error_text(), "");
    std::vector<Eigen::Vector3d> path;
    for (size_t i = kBackFrom; i < kGapEnd; ++i)
      path.push_back(tracker.process(rendered_walk().utime_us[i] + kLaterUs, rendered_walk().images[i])
                         ->cam_from_submap.translation);
    return path;
  };
  EXPECT_EQ(run(), run());
}

// As ReturnToTheGap, but over messages, with a stand-in for map_server.
class NodeReturnsToTheGap : public ::testing::Test {
 protected:
  explicit NodeReturnsToTheGap(int back_keyframes = 400) : sender_(bus_, channels::kMapChunk, channels::kMapAck, "s") {
    FrontTrackerOptions options = replay_options();
    options.tracking.back_keyframes = back_keyframes;
    node_ = std::make_unique<FrontTrackerNode>(bus_, options);
    bus_.subscribe<track_t>(channels::kTrack, {}, [this](const track_t& t) { tracks_.push_back(t); });
    bus_.subscribe<map_request_t>(channels::kMapRequest, {}, [this](const map_request_t& r) {
      ++requests_;
      sender_.send(r.requester, chunk_t::SUBMAP_UPDATE, r.request_id, encode_message(make_submap_update(back_, 0)),
                   [](const TransferResult& result) { EXPECT_TRUE(result.ok) << result.reason; });
    });
    for (size_t i = 0; i < 30; ++i) give(walk_.utime_us[i], walk_.images[i]);
    const cv::Mat black(walk_.images[0].size(), CV_8U, cv::Scalar(0));
    give(walk_.utime_us[kGapBegin], black);
    back_ = rebuilt(walk_);
    back_.key.session = tracks_.back().session;
  }
  void give(int64_t utime_us, const cv::Mat& grey) {
    image_t image = make_grey_image(utime_us, grey);
    set_metadata(&image, kCalibrationKey, camera_to_yaml(walk_.camera));
    bus_.set_now_us(utime_us);
    bus_.publish(channels::kCamera, image);
    bus_.dispatch();
    node_->tick(utime_us);
    sender_.tick(utime_us);
    bus_.dispatch();
  }
  void tell_of_the_map(bool in_map) {
    map_status_t status{};
    submap_summary_t& summary = status.submaps.emplace_back();
    status.nsubmaps = 1;
    summary = {};
    summary.session = back_.key.session;
    summary.submap_id = back_.key.id;
    summary.kind = submap_update_t::BACK;
    summary.closed = true;
    summary.in_map = in_map;
    summary.revision = back_.revision;
    summary.keyframes = static_cast<int32_t>(back_.keyframes.size());
    summary.map_from_submap = to_wire(Sim3());
    status.utime = bus_.now_us();
    bus_.publish(channels::kMapStatus, status);
    bus_.dispatch();
  }
  track_t come_back(size_t i) {
    give(walk_.utime_us[i] + kLaterUs, walk_.images[i]);
    return tracks_.back();
  }
  const RenderedWalk& walk_ = rendered_walk();
  MemoryBus bus_;
  ChunkSender sender_;
  Submap back_;
  int requests_ = 0;
  std::vector<track_t> tracks_;
  std::unique_ptr<FrontTrackerNode> node_;
};

TEST_F(NodeReturnsToTheGap, AsSoonAsTheMapHoldsTheBackSubmap) {
  tell_of_the_map(false);
  EXPECT_EQ(requests_, 0);
  tell_of_the_map(true);
  EXPECT_EQ(requests_, 1);
  EXPECT_NE(node_->status().detail.find("1 back submaps"), std::string::npos) << node_->status().detail;
  const track_t track = come_back(kBackFrom);
  EXPECT_EQ(track.state, track_t::TRACKING);
  EXPECT_EQ(track.submap_id, 2);
  for (const track_t& t : tracks_)
    EXPECT_FALSE(t.utime < track.utime && t.submap_id == 2) << "images of the back submap are not told as tracked";
}

TEST_F(NodeReturnsToTheGap, NotWhenTheMapHasDroppedIt) {
  tell_of_the_map(true);
  tell_of_the_map(false);
  EXPECT_NE(come_back(kBackFrom).state, track_t::TRACKING);
}

class NodeWithoutBackSubmaps : public NodeReturnsToTheGap {
 protected:
  NodeWithoutBackSubmaps() : NodeReturnsToTheGap(0) {}
};

TEST_F(NodeWithoutBackSubmaps, AsksForNone) {
  tell_of_the_map(true);
  EXPECT_EQ(requests_, 0);
  EXPECT_NE(come_back(kBackFrom).state, track_t::TRACKING);
}

}  // namespace
}  // namespace rumi::front_tracker
