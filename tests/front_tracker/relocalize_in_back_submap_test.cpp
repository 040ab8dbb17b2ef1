// SPDX-License-Identifier: BSD-3-Clause
// The tracker is lost, comes back to a place that only rumination has rebuilt, and goes on there.
#include <gtest/gtest.h>

#include "front_tracker/tracker.h"
#include "tests/front_tracker/rendered_walk.h"

namespace rumi {
namespace {

using testing::render_walk;
using testing::rendered_walk;
using testing::RenderedWalk;
using testing::replay_options;

constexpr size_t kGapBegin = 60, kGapEnd = 120;  // images of the walk that the front never sees in time
constexpr size_t kBackFrom = 72;                 // where it comes back to
constexpr int64_t kLaterUs = 20'000'000;

// What rumination would make of the gap, in a unit of its own: keyframes only. own_poses receives the poses of all
// images in it.
Submap rebuilt(const RenderedWalk& walk, std::map<int64_t, SE3>* own_poses = nullptr) {
  Tracker tracker(walk.camera, replay_options(), 1);
  for (size_t i = kGapBegin; i < kGapEnd; ++i) tracker.process(walk.utime_us[i], walk.images[i]);
  EXPECT_EQ(tracker.submaps().size(), 1u);
  Submap submap = tracker.submaps()[0]->map;
  submap.key = {1, -1};
  submap.kind = SubmapKind::kBack;
  submap.closed = true;
  for (auto& [id, kf] : submap.keyframes) kf.cam_from_submap.translation *= 3;
  for (auto& [id, lm] : submap.landmarks) lm.position *= 3;
  for (auto& [utime_us, frame] : submap.frames) frame.cam_from_keyframe.translation *= 3;
  if (own_poses)
    for (const auto& [utime_us, frame] : submap.frames) (*own_poses)[utime_us] = submap.cam_from_submap(frame);
  submap.frames.clear();
  for (const auto& [id, kf] : submap.keyframes) submap.frames[kf.utime_us] = {kf.utime_us, id, SE3(), 1};
  return submap;
}

// Sees the first images, then nothing for 1.5 s.
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
  ASSERT_EQ(tracker_.add_back_submap(back), "");
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
  // The same images, as map_server needs them to join the two; and in the same unit.
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
  std::map<int64_t, SE3> truth;
  const Submap submap = rebuilt(walk, &truth);
  const FrontTrackerOptions options = replay_options();
  BackSubmaps back(walk.camera, options.tracking, octave_scales(options.orb));
  ASSERT_EQ(back.add(submap, [](int64_t) { return false; }), "");
  const OrbExtractor extractor(options.orb);
  const int64_t first_us = submap.frames.begin()->first, last_us = submap.frames.rbegin()->first;
  const double path = (truth.at(first_us).center() - truth.at(last_us).center()).norm();
  int tried = 0, found = 0;
  for (size_t i = kGapBegin; i < kGapEnd; ++i) {
    const int64_t utime_us = walk.utime_us[i];
    if (utime_us < first_us || utime_us > last_us || submap.frame(utime_us)) continue;  // the very image is no test
    Frame frame = make_frame(utime_us, extractor.extract(walk.images[i]), walk.camera);
    BackSubmaps untouched = back;
    ++tried;
    if (!untouched.relocalize(&frame)) continue;
    ++found;
    EXPECT_LT((frame.cam_from_submap.center() - truth.at(utime_us).center()).norm(), 0.02 * path) << "image " << i;
  }
  EXPECT_GE(tried, 30);
  EXPECT_GE(found, 0.95 * tried);
}

TEST_F(ReturnToTheGap, AnotherRoomIsNotTakenForThisOne) {
  ASSERT_EQ(tracker_.add_back_submap(rebuilt(render_walk(6, 20, 5))), "");
  for (size_t i = kBackFrom; i < kBackFrom + 3; ++i) EXPECT_EQ(come_back(i).submap_id, kNoSubmap);
  EXPECT_EQ(tracker_.back_submaps().submaps(), 1u);
}

TEST_F(ReturnToTheGap, WhatTheFrontSawItFindsInItsOwnSubmap) {
  ASSERT_EQ(tracker_.add_back_submap(rebuilt(rendered_walk())), "");
  EXPECT_EQ(come_back(20).submap_id, 1);
  EXPECT_EQ(tracker_.back_submaps().submaps(), 1u);
}

TEST_F(ReturnToTheGap, RepeatsItself) {
  const Submap back = rebuilt(rendered_walk());
  const auto run = [&] {
    Tracker tracker(rendered_walk().camera, replay_options(), 1);
    for (size_t i = 0; i < 30; ++i) tracker.process(rendered_walk().utime_us[i], rendered_walk().images[i]);
    const cv::Mat black(rendered_walk().images[0].size(), CV_8U, cv::Scalar(0));
    tracker.process(rendered_walk().utime_us[kGapBegin], black);
    tracker.add_back_submap(back);
    std::vector<Eigen::Vector3d> path;
    for (size_t i = kBackFrom; i < kGapEnd; ++i)
      path.push_back(tracker.process(rendered_walk().utime_us[i] + kLaterUs, rendered_walk().images[i])
                         ->cam_from_submap.translation);
    return path;
  };
  EXPECT_EQ(run(), run());
}

}  // namespace
}  // namespace rumi
