// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/window_sampler.h"

#include <gmock/gmock.h>

#include <numeric>

namespace rumi {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::vector<int64_t> utimes(const std::vector<Sample>& samples) {
  std::vector<int64_t> list;
  list.reserve(samples.size());
  for (const Sample& s : samples) list.push_back(s.utime_us);
  return list;
}

std::vector<int64_t> keyframes(const std::vector<Sample>& samples) {
  std::vector<int64_t> list;
  for (const Sample& s : samples)
    if (s.is_keyframe) list.push_back(s.utime_us);
  return list;
}

// Poses that tell the frames apart.
SE3 pose_of(int64_t utime_us) {
  return {Eigen::Quaterniond::Identity(), Eigen::Vector3d(static_cast<double>(utime_us), 0, 1)};
}

// Frames 1, 2, 3, ... (also their utime); 'span' frames in one state, every n-th a keyframe.
class Feed {
 public:
  explicit Feed(const WindowOptions& options = {}) : sampler(options) {}
  void span(int frames, int32_t submap, int keyframe_every = 0, bool has_image = true) {
    for (int i = 0; i < frames; ++i) {
      ++now;
      const bool is_keyframe = submap != kNoSubmap && keyframe_every > 0 && i % keyframe_every == 0;
      auto ended = sampler.process({.utime_us = now,
                                    .session = session,
                                    .submap_id = submap,
                                    .cam_from_submap = submap == kNoSubmap ? SE3() : pose_of(now),
                                    .is_keyframe = is_keyframe,
                                    .has_image = has_image,
                                    .image = {.motion_px = motion_px, .sharpness = 1}});
      if (ended) windows.push_back(*ended);
    }
  }
  // front_tracker tells of a frame once more, which got its pose afterwards.
  void late_pose(int64_t utime, int32_t submap, bool is_keyframe = false) {
    auto ended = sampler.process({.utime_us = utime,
                                  .session = session,
                                  .submap_id = submap,
                                  .cam_from_submap = pose_of(utime),
                                  .is_keyframe = is_keyframe});
    EXPECT_FALSE(ended);
  }
  // front_tracker tells of frames once more, whose poses it takes back.
  void withdraw(int64_t first, int64_t last) {
    for (int64_t utime = first; utime <= last; ++utime)
      EXPECT_FALSE(sampler.process({.utime_us = utime, .session = session}));
  }
  void finish() {
    if (auto ended = sampler.finish("the input ended")) windows.push_back(*ended);
  }
  WindowSampler sampler;
  std::vector<RuminationWindow> windows;
  int64_t now = 0, session = 7;
  double motion_px = 5;
};

TEST(WindowSampler, NothingHappensWithoutALoss) {
  Feed feed;
  feed.span(500, 1, 10);
  feed.span(100, 2, 10);  // from one submap to another without an untracked frame
  feed.finish();
  EXPECT_THAT(feed.windows, IsEmpty());
  EXPECT_FALSE(feed.sampler.open());
  EXPECT_LE(feed.sampler.retained().size(), 61) << "of the approach, with what may yet be withdrawn";
}

TEST(WindowSampler, OneLossIsOneWindowOfThreeParts) {
  Feed feed({.stride = 5, .window_length = 4, .shared_keyframes = 3, .departure_min_keyframes = 3});
  feed.span(103, 1);  // 1..103: samples at 1, 6, ..., 101
  feed.span(7, kNoSubmap);
  ASSERT_TRUE(feed.sampler.open());
  EXPECT_TRUE(feed.sampler.open()->is_lost());
  feed.span(30, 2, 10);  // 111.. keyframes at 111, 121, 131
  ASSERT_EQ(feed.windows.size(), 1);
  const RuminationWindow& w = feed.windows[0];
  EXPECT_EQ(w.id, 1);
  EXPECT_EQ(w.session, 7);
  EXPECT_EQ(w.submap_before, 1);
  EXPECT_EQ(w.submap_after, 2);
  EXPECT_EQ(w.lost_utime_us, 104);
  EXPECT_EQ(w.resumed_utime_us, 111);
  EXPECT_THAT(utimes(w.approach), ElementsAre(91, 96, 101, 103));  // the last tracked frame is always there
  EXPECT_THAT(utimes(w.gap), ElementsAre(104, 105, 106, 107, 108, 109, 110));
  EXPECT_THAT(utimes(w.departure), ElementsAre(111, 116, 121, 126, 131));
  EXPECT_TRUE(w.departure[0].is_keyframe && w.departure[2].is_keyframe);
  EXPECT_EQ(w.reason, "");
  EXPECT_FALSE(feed.sampler.open());
}

TEST(WindowSampler, ALossBeforeTheFirstSubmapHasNoApproach) {
  Feed feed;
  feed.span(12, kNoSubmap);
  feed.span(200, 1, 4);
  ASSERT_EQ(feed.windows.size(), 1);
  EXPECT_EQ(feed.windows[0].submap_before, kNoSubmap);
  EXPECT_EQ(feed.windows[0].submap_after, 1);
  EXPECT_THAT(feed.windows[0].approach, IsEmpty());
  EXPECT_EQ(feed.windows[0].gap.size(), 12);
  EXPECT_EQ(feed.windows[0].gap_frames, 12);
}

TEST(WindowSampler, ALossThatNeverResumesEndsWithTheInput) {
  Feed feed;
  feed.span(50, 1, 10);
  feed.span(20, kNoSubmap);
  EXPECT_THAT(feed.windows, IsEmpty());
  feed.finish();
  ASSERT_EQ(feed.windows.size(), 1);
  EXPECT_EQ(feed.windows[0].submap_after, kNoSubmap);
  EXPECT_EQ(feed.windows[0].resumed_utime_us, 0);
  EXPECT_EQ(feed.windows[0].gap.size(), 20);
  EXPECT_EQ(feed.windows[0].reason, "the input ended");
  feed.finish();
  EXPECT_EQ(feed.windows.size(), 1);
}

TEST(WindowSampler, ASubmapThatDiedYoungIsPartOfTheGap) {
  Feed feed;
  feed.span(50, 1, 10);
  feed.span(5, kNoSubmap);  // 51..55
  feed.span(12, 2, 5);      // 56..67: three keyframes
  feed.span(4, kNoSubmap);  // 68..71
  feed.span(100, 3, 5);     // 72..
  ASSERT_EQ(feed.windows.size(), 1);
  const RuminationWindow& w = feed.windows[0];
  EXPECT_EQ(w.submap_before, 1);
  EXPECT_EQ(w.submap_after, 3);
  EXPECT_EQ(w.lost_utime_us, 51);
  EXPECT_EQ(w.resumed_utime_us, 72);
  ASSERT_EQ(w.gap.size(), 21);
  for (size_t i = 0; i < w.gap.size(); ++i) EXPECT_EQ(w.gap[i].utime_us, 51 + static_cast<int64_t>(i));
  EXPECT_EQ(w.departure.front().utime_us, 72);
}

TEST(WindowSampler, TrackedSamplesSayWhereTheyWereTracked) {
  Feed feed;
  feed.span(50, 1, 10);
  feed.span(5, kNoSubmap);  // 51..55
  feed.span(12, 2, 5);      // 56..67, dies young
  feed.span(4, kNoSubmap);  // 68..71
  feed.span(100, 3, 5);
  ASSERT_EQ(feed.windows.size(), 1);
  const auto expect_tracked_in = [](const std::vector<Sample>& samples, int32_t submap_id) {
    for (const Sample& s : samples) {
      EXPECT_EQ(s.submap_id, submap_id) << s.utime_us;
      EXPECT_EQ(s.cam_from_submap.translation.x(), static_cast<double>(s.utime_us));
    }
  };
  const RuminationWindow& w = feed.windows[0];
  ASSERT_EQ(w.gap.size(), 21);
  expect_tracked_in(w.approach, 1);
  expect_tracked_in(w.departure, 3);
  EXPECT_THAT(keyframes(w.gap), ElementsAre(56, 61, 66));
  expect_tracked_in({w.gap.begin() + 5, w.gap.begin() + 17}, 2);
  for (const Sample& s : w.gap) EXPECT_EQ(s.submap_id, s.utime_us < 56 || s.utime_us > 67 ? kNoSubmap : 2);
}

TEST(WindowSampler, LosingAKnownSubmapAgainSoonIsOneWindow) {
  Feed feed;
  feed.span(50, 1, 10);
  feed.span(5, kNoSubmap);  // 51..55
  feed.span(20, 1, 0);      // relocalized: 56..75, no new keyframes, four samples
  feed.span(5, kNoSubmap);  // 76..80
  feed.span(100, 2, 5);
  ASSERT_EQ(feed.windows.size(), 1);
  const RuminationWindow& w = feed.windows[0];
  EXPECT_EQ(w.lost_utime_us, 51);
  EXPECT_EQ(w.resumed_utime_us, 81);
  EXPECT_EQ(w.submap_before, 1);
  EXPECT_EQ(w.submap_after, 2);
  EXPECT_EQ(keyframes(w.approach).size(), 5) << "those from before the first loss";
  EXPECT_EQ(w.gap_frames, 30);
  EXPECT_EQ(w.gap[10].submap_id, 1) << "tracked in between: it ties the gap to the submap too";
}

TEST(WindowSampler, LosingAKnownSubmapLaterMakesTwoWindows) {
  Feed feed({.window_length = 10});
  feed.span(50, 1, 10);
  feed.span(5, kNoSubmap);
  feed.span(60, 2, 4);
  feed.span(5, kNoSubmap);
  feed.span(60, 1, 0);  // relocalized: 121..180, not enough keyframes to be complete, but samples
  EXPECT_EQ(feed.windows.size(), 1);
  feed.span(5, kNoSubmap);
  ASSERT_EQ(feed.windows.size(), 2);
  EXPECT_EQ(feed.windows[1].reason, "");
  EXPECT_EQ(feed.windows[1].submap_after, 1);
  EXPECT_EQ(feed.windows[1].departure.size(), 12);
  EXPECT_EQ(feed.sampler.open()->id, 3);
  EXPECT_EQ(feed.sampler.open()->submap_before, 1);
  feed.span(100, 1, 0);
  ASSERT_EQ(feed.windows.size(), 3);
  EXPECT_EQ(feed.windows[2].departure.size(), 10) << "window_length samples are enough, it is the same submap";
}

TEST(WindowSampler, ACameraThatStandsStillCompletesTheWindowToo) {
  Feed feed({.departure_max_samples = 6});
  feed.span(5, kNoSubmap);
  feed.span(1000, 1, 0);
  ASSERT_EQ(feed.windows.size(), 1);
  EXPECT_EQ(feed.windows[0].departure.size(), 6);
}

TEST(WindowSampler, ChangingSubmapDuringDepartureEndsTheWindow) {
  Feed feed;
  feed.span(50, 1, 10);
  feed.span(5, kNoSubmap);
  feed.span(12, 2, 5);
  feed.span(50, 1, 0);
  ASSERT_EQ(feed.windows.size(), 1);
  EXPECT_EQ(feed.windows[0].submap_after, 2);
  EXPECT_THAT(feed.windows[0].reason, HasSubstr("submap 1"));
}

TEST(WindowSampler, ALongGapIsThinnedButCountedInFull) {
  Feed feed({.gap_max_frames = 16});
  feed.span(1000, kNoSubmap);
  feed.finish();
  const RuminationWindow& w = feed.windows.at(0);
  EXPECT_EQ(w.gap.size(), 16);
  EXPECT_EQ(w.gap_frames, 1000);
  EXPECT_EQ(w.gap.front().utime_us, 1);
  EXPECT_EQ(w.gap.back().utime_us, 1000);
}

TEST(WindowSampler, ThinningOnDemandLastsForTheWindow) {
  Feed feed;
  feed.span(11, kNoSubmap);
  EXPECT_TRUE(feed.sampler.thin_gap());
  EXPECT_EQ(feed.sampler.open()->gap.size(), 6);
  feed.span(100, kNoSubmap);
  EXPECT_EQ(feed.sampler.open()->gap.size(), 6);
  while (feed.sampler.thin_gap()) {
  }
  EXPECT_THAT(utimes(feed.sampler.open()->gap), ElementsAre(1, 111));
  feed.finish();
  EXPECT_FALSE(feed.sampler.thin_gap());
  feed.span(100, kNoSubmap);
  EXPECT_EQ(feed.sampler.open()->gap.size(), 100);
}

TEST(WindowSampler, ADyingSubmapDoesNotExceedTheCap) {
  Feed feed({.gap_max_frames = 20});
  feed.span(50, 1, 10);
  feed.span(15, kNoSubmap);  // 51..65
  feed.span(15, 2, 5);       // 66..80
  feed.span(1, kNoSubmap);
  ASSERT_TRUE(feed.sampler.open());
  EXPECT_EQ(feed.sampler.open()->gap.size(), 20);
  EXPECT_EQ(feed.sampler.open()->gap_frames, 31);
  EXPECT_LE(feed.sampler.retained().size(), 20 + 11);
}

TEST(WindowSampler, ACameraThatHardlyMovesLeavesFewSamples) {
  Feed feed({.gap_dense_frames = 0, .gap_min_motion_px = 2});
  feed.motion_px = 0.5;
  feed.span(41, kNoSubmap);
  feed.finish();
  EXPECT_THAT(utimes(feed.windows.at(0).gap), ElementsAre(1, 5, 9, 13, 17, 21, 25, 29, 33, 37, 41));
}

TEST(WindowSampler, FramesWithoutImageCountForTheStateOnly) {
  Feed feed;
  feed.span(50, 1, 10);
  feed.span(3, kNoSubmap, 0, false);  // 51..53
  feed.span(3, kNoSubmap);
  feed.span(1, 2, 1, false);  // 57: the resuming frame itself
  feed.span(100, 2, 4);
  ASSERT_EQ(feed.windows.size(), 1);
  EXPECT_EQ(feed.windows[0].lost_utime_us, 51);
  EXPECT_EQ(feed.windows[0].resumed_utime_us, 57);
  EXPECT_THAT(utimes(feed.windows[0].gap), ElementsAre(54, 55, 56));
  EXPECT_EQ(feed.windows[0].departure.front().utime_us, 58);
}

TEST(WindowSampler, RepeatedAndLateFramesAreIgnored) {
  Feed feed;
  feed.span(50, 1, 10);
  feed.now = 20;
  feed.span(30, 1);  // 21..50 once more, and not in order
  EXPECT_EQ(feed.sampler.ignored(), 30);
  EXPECT_FALSE(feed.sampler.open());
  feed.span(5, kNoSubmap);
  feed.withdraw(51, 55);  // they never had a pose
  EXPECT_EQ(feed.sampler.ignored(), 35);
  EXPECT_EQ(feed.sampler.open()->gap_frames, 5);
}

TEST(WindowSampler, ANewSessionStartsAfresh) {
  Feed feed;
  feed.span(50, 1, 10);
  feed.span(5, kNoSubmap);
  feed.session = 8;
  feed.now = 0;  // even if its time starts again
  feed.span(4, kNoSubmap);
  ASSERT_EQ(feed.windows.size(), 1);
  EXPECT_THAT(feed.windows[0].reason, HasSubstr("started again"));
  ASSERT_TRUE(feed.sampler.open());
  EXPECT_EQ(feed.sampler.open()->session, 8);
  EXPECT_EQ(feed.sampler.open()->submap_before, kNoSubmap);
  EXPECT_EQ(feed.sampler.open()->gap.size(), 4);
  EXPECT_EQ(feed.sampler.open()->id, 2);
}

TEST(WindowSampler, WhatAWindowNeedsIsRetained) {
  Feed feed;
  feed.span(73, 1, 7);
  feed.span(20, kNoSubmap);
  feed.span(25, 2, 6);
  const std::set<int64_t> retained = feed.sampler.retained();
  ASSERT_TRUE(feed.sampler.open());
  for (const Sample& s : feed.sampler.open()->samples()) EXPECT_TRUE(retained.contains(s.utime_us)) << s.utime_us;
  for (int64_t utime = 94; utime <= 118; ++utime) EXPECT_TRUE(retained.contains(utime)) << utime;  // may die young
}

TEST(WindowSampler, TenKeyframesAreSharedOnEachSideWhereThereAreSoMany) {
  Feed feed;
  feed.span(400, 1, 12);  // keyframes at 1, 13, ..., 397
  feed.span(10, kNoSubmap);
  feed.span(400, 2, 12);
  ASSERT_EQ(feed.windows.size(), 1);
  const RuminationWindow& w = feed.windows[0];
  EXPECT_THAT(keyframes(w.approach), ElementsAre(289, 301, 313, 325, 337, 349, 361, 373, 385, 397));
  EXPECT_EQ(w.approach.back().utime_us, 400);
  EXPECT_LE(w.approach.size(), 20);
  EXPECT_EQ(keyframes(w.departure).size(), 10);
  EXPECT_EQ(w.departure.back().utime_us, 411 + 9 * 12);  // with the tenth keyframe
}

TEST(WindowSampler, AShortSubmapSharesWhatItHas) {
  Feed feed;
  feed.span(5, kNoSubmap);
  feed.span(90, 1, 10);  // nine keyframes
  feed.span(5, kNoSubmap);
  ASSERT_TRUE(feed.sampler.open());
  EXPECT_EQ(keyframes(feed.sampler.open()->approach).size(), 9);
}

TEST(WindowSampler, LostBetweenEnoughAndManyKeyframesTheWindowIsComplete) {
  Feed feed({.shared_keyframes = 10, .departure_min_keyframes = 8});
  feed.span(50, 1, 10);
  feed.span(5, kNoSubmap);
  feed.span(36, 2, 4);  // nine keyframes
  EXPECT_THAT(feed.windows, IsEmpty());
  feed.span(5, kNoSubmap);
  ASSERT_EQ(feed.windows.size(), 1);
  EXPECT_EQ(feed.windows[0].reason, "");
  EXPECT_EQ(feed.windows[0].submap_after, 2);
  EXPECT_EQ(keyframes(feed.windows[0].departure).size(), 9);
  EXPECT_EQ(feed.sampler.open()->submap_before, 2);
  EXPECT_EQ(feed.sampler.open()->id, 2);
  feed.span(28, 3, 4);  // seven: died young
  feed.span(5, kNoSubmap);
  EXPECT_EQ(feed.windows.size(), 1);
  EXPECT_EQ(feed.sampler.open()->gap_frames, 38);
}

TEST(WindowSampler, RelocalizationInAnotherKnownSubmapWaitsForKeyframesToShare) {
  Feed feed;
  feed.span(50, 1, 10);
  feed.span(5, kNoSubmap);
  feed.span(200, 2, 10);
  feed.span(5, kNoSubmap);
  feed.span(200, 1, 5);
  ASSERT_EQ(feed.windows.size(), 2);
  EXPECT_EQ(feed.windows[1].submap_before, 2);
  EXPECT_EQ(feed.windows[1].submap_after, 1);
  EXPECT_EQ(keyframes(feed.windows[1].departure).size(), 10);
}

TEST(WindowSampler, FramesPosedAfterwardsAreDepartureNotGap) {
  Feed feed;
  feed.span(100, 1, 10);
  feed.span(20, kNoSubmap);  // 101..120
  for (int64_t utime = 110; utime <= 120; ++utime)
    if (utime != 115) feed.late_pose(utime, 2, utime % 5 == 0);
  feed.span(100, 2, 10);  // 121
  ASSERT_EQ(feed.windows.size(), 1);
  const RuminationWindow& w = feed.windows[0];
  EXPECT_EQ(w.lost_utime_us, 101);
  EXPECT_EQ(w.resumed_utime_us, 116);
  EXPECT_THAT(utimes(w.gap), ElementsAre(101, 102, 103, 104, 105, 106, 107, 108, 109, 110, 111, 112, 113, 114, 115))
      << "the departure begins after the last frame without a pose: a job's images are in order of time";
  EXPECT_EQ(w.gap_frames, 15);
  EXPECT_THAT(keyframes(w.departure), ElementsAre(120, 121, 131, 141, 151, 161, 171, 181, 191, 201));
  for (const Sample& s : w.departure) {
    EXPECT_EQ(s.submap_id, 2);
    EXPECT_EQ(s.cam_from_submap.translation.x(), static_cast<double>(s.utime_us));
  }
  EXPECT_EQ(feed.sampler.ignored(), 0);
}

TEST(WindowSampler, AStartOfWhichAllFramesGetPosesIsNoWindow) {
  Feed feed;
  feed.span(20, kNoSubmap);
  ASSERT_TRUE(feed.sampler.open());
  EXPECT_FALSE(feed.sampler.is_settled()) << "not to be announced yet";
  for (int64_t utime = 1; utime <= 20; ++utime) feed.late_pose(utime, 1, utime == 1);
  EXPECT_TRUE(feed.sampler.open());
  feed.span(1, 1, 1);
  EXPECT_FALSE(feed.sampler.open());
  feed.span(100, 1, 10);
  feed.span(5, kNoSubmap);
  ASSERT_TRUE(feed.sampler.open());
  EXPECT_TRUE(feed.sampler.is_settled());
  EXPECT_EQ(feed.sampler.open()->id, 1) << "nobody has heard of the other";
  EXPECT_THAT(feed.windows, IsEmpty());
}

TEST(WindowSampler, AStartOfWhichAFrameRemainsIsAWindow) {
  Feed feed;
  feed.span(20, kNoSubmap);
  for (int64_t utime = 2; utime <= 20; ++utime) feed.late_pose(utime, 1);
  feed.span(1, 1, 1);
  ASSERT_TRUE(feed.sampler.open());
  EXPECT_TRUE(feed.sampler.is_settled());
  EXPECT_THAT(utimes(feed.sampler.open()->gap), ElementsAre(1));
}

TEST(WindowSampler, WithoutAnyGapTwoSubmapsStillNeedToBeConnected) {
  Feed feed;
  feed.span(100, 1, 10);
  feed.span(10, kNoSubmap);
  for (int64_t utime = 101; utime <= 110; ++utime) feed.late_pose(utime, 2, utime == 101);
  feed.span(200, 2, 10);
  ASSERT_EQ(feed.windows.size(), 1);
  const RuminationWindow& w = feed.windows[0];
  EXPECT_THAT(w.gap, IsEmpty());
  EXPECT_EQ(w.gap_frames, 0);
  EXPECT_EQ(w.departure.front().utime_us, 101);
  EXPECT_EQ(w.submap_before, 1);
  EXPECT_EQ(w.submap_after, 2);
}

TEST(WindowSampler, PosedAfterwardsInASubmapThatDiesYoungIsGapAgain) {
  Feed feed;
  feed.span(100, 1, 10);
  feed.span(10, kNoSubmap);  // 101..110
  for (int64_t utime = 104; utime <= 110; ++utime)
    if (utime != 107) feed.late_pose(utime, 2, utime == 104);
  feed.span(3, 2, 3);  // 111..113
  feed.span(2, kNoSubmap);
  ASSERT_TRUE(feed.sampler.open());
  const RuminationWindow& w = *feed.sampler.open();
  EXPECT_EQ(w.gap_frames, 15);
  EXPECT_EQ(utimes(w.gap),
            (std::vector<int64_t>{101, 102, 103, 104, 105, 106, 107, 108, 109, 110, 111, 112, 113, 114, 115}));
  EXPECT_EQ(w.gap[3].submap_id, 2);
  EXPECT_EQ(w.gap[6].submap_id, kNoSubmap);
  EXPECT_TRUE(w.is_lost());
}

TEST(WindowSampler, APoseAfterwardsBeforeAFrameThatHasNoneIsGap) {
  Feed feed({.stride = 5, .window_length = 4, .shared_keyframes = 3, .departure_min_keyframes = 3});
  feed.span(50, 1, 10);
  feed.span(10, kNoSubmap);  // 51..60
  for (int64_t utime : {55, 56, 58, 59, 60}) feed.late_pose(utime, 2, utime == 55);
  feed.span(30, 2, 10);
  ASSERT_EQ(feed.windows.size(), 1);
  const RuminationWindow& w = feed.windows[0];
  EXPECT_THAT(utimes(w.gap), ElementsAre(51, 52, 53, 54, 55, 56, 57));
  EXPECT_TRUE(w.gap[4].is_keyframe);
  EXPECT_EQ(w.gap[4].submap_id, 2);
  EXPECT_EQ(w.gap_frames, 7);
  EXPECT_EQ(w.resumed_utime_us, 58);
  EXPECT_GE(w.departure.front().utime_us, 58);
}

TEST(WindowSampler, LatePosesOfASubmapNeverHeardOfAgainChangeNothing) {
  Feed feed;
  feed.span(100, 1, 10);
  feed.span(10, kNoSubmap);
  feed.late_pose(105, 9);
  feed.late_pose(104, 9);
  EXPECT_TRUE(feed.sampler.retained().contains(105));
  feed.span(200, 2, 10);
  ASSERT_EQ(feed.windows.size(), 1);
  EXPECT_EQ(feed.windows[0].gap.size(), 10);
  EXPECT_EQ(feed.windows[0].gap_frames, 10);
  EXPECT_EQ(feed.windows[0].resumed_utime_us, 111);
}

TEST(WindowSampler, LatePosesMayComeTooLateTwiceOrForOtherFrames) {
  Feed feed;
  feed.span(100, 1, 10);
  feed.span(10, kNoSubmap);  // 101..110
  feed.late_pose(50, 2);     // was tracked
  feed.late_pose(105, 2);
  feed.late_pose(105, 2);
  feed.late_pose(106, kNoSubmap);
  EXPECT_EQ(feed.sampler.ignored(), 3);
  feed.span(5, 2, 10);
  feed.late_pose(103, 2);  // behind the frame that it was to precede
  EXPECT_THAT(utimes(feed.sampler.open()->gap), ElementsAre(101, 102, 104, 105, 106, 107, 108, 109, 110));
  EXPECT_EQ(feed.sampler.open()->gap_frames, 9);
  EXPECT_EQ(feed.sampler.open()->resumed_utime_us, 103);
  EXPECT_EQ(feed.sampler.ignored(), 3);
}

std::vector<int64_t> from_to(int64_t first, int64_t last) {
  std::vector<int64_t> list(static_cast<size_t>(last - first + 1));
  std::iota(list.begin(), list.end(), first);
  return list;
}

void expect_no_poses(const std::vector<Sample>& samples) {
  for (const Sample& s : samples) EXPECT_TRUE(s.submap_id == kNoSubmap && !s.is_keyframe) << s.utime_us;
}

TEST(WindowSampler, PosesWithdrawnAfterALossAreItsGap) {
  Feed feed({.window_length = 4, .shared_keyframes = 4});
  feed.span(60, 1, 1);
  feed.span(2, kNoSubmap);
  feed.withdraw(50, 60);
  EXPECT_EQ(feed.sampler.open()->lost_utime_us, 50);
  feed.span(30, 1, 1);
  ASSERT_EQ(feed.windows.size(), 1);
  const RuminationWindow& w = feed.windows[0];
  EXPECT_EQ(w.lost_utime_us, 50);
  EXPECT_EQ(w.resumed_utime_us, 63);
  EXPECT_EQ(utimes(w.approach), from_to(46, 49));
  EXPECT_EQ(utimes(w.gap), from_to(50, 62));
  EXPECT_EQ(w.gap_frames, 13);
  expect_no_poses(w.gap);
  EXPECT_EQ(feed.sampler.ignored(), 0);
}

TEST(WindowSampler, PosesWithdrawnWithoutALossOpenAWindow) {
  Feed feed({.window_length = 4, .shared_keyframes = 4});
  feed.span(60, 1, 1);
  feed.withdraw(55, 60);
  ASSERT_TRUE(feed.sampler.open());
  EXPECT_TRUE(feed.sampler.open()->is_lost());
  feed.span(30, 1, 1);
  ASSERT_EQ(feed.windows.size(), 1);
  const RuminationWindow& w = feed.windows[0];
  EXPECT_EQ(w.submap_before, 1);
  EXPECT_EQ(w.submap_after, 1);
  EXPECT_EQ(utimes(w.approach), from_to(51, 54));
  EXPECT_EQ(utimes(w.gap), from_to(55, 60));
  EXPECT_EQ(w.gap_frames, 6);
  EXPECT_EQ(feed.sampler.ignored(), 0);
}

TEST(WindowSampler, PosesWithdrawnFromADepartureProlongTheGap) {
  Feed feed({.window_length = 12, .shared_keyframes = 12});
  feed.span(60, 1, 1);
  feed.span(3, kNoSubmap);
  feed.span(9, 1, 1);
  feed.withdraw(66, 72);
  feed.span(30, 1, 1);
  ASSERT_EQ(feed.windows.size(), 1);
  const RuminationWindow& w = feed.windows[0];
  EXPECT_EQ(w.lost_utime_us, 61);
  EXPECT_EQ(w.resumed_utime_us, 73);
  EXPECT_EQ(utimes(w.gap), from_to(61, 72));
  EXPECT_EQ(w.gap_frames, 12);
  EXPECT_EQ(w.gap[4].submap_id, 1) << "of the departure, and not withdrawn";
  expect_no_poses({w.gap.begin() + 5, w.gap.end()});
}

TEST(WindowSampler, WithdrawnFramesThatAreNoSamplesCount) {
  Feed feed({.stride = 5, .window_length = 4, .shared_keyframes = 4});
  feed.span(60, 1);  // samples at 1, 6, ..., 56
  feed.span(2, kNoSubmap);
  feed.withdraw(48, 60);
  const RuminationWindow& w = *feed.sampler.open();
  EXPECT_THAT(utimes(w.approach), ElementsAre(31, 36, 41, 46));
  EXPECT_THAT(utimes(w.gap), ElementsAre(51, 56, 60, 61, 62));
  EXPECT_EQ(w.gap_frames, 15);
  const std::set<int64_t> retained = feed.sampler.retained();
  for (const Sample& s : w.samples()) EXPECT_TRUE(retained.contains(s.utime_us)) << s.utime_us;
}

TEST(WindowSampler, WithdrawnLongAgoTwiceOrOfNobodyChangesNothing) {
  Feed feed({.window_length = 4, .shared_keyframes = 4});
  feed.span(30, 1, 1);
  feed.span(2, kNoSubmap);
  feed.span(40, 2, 1);  // completes the window
  ASSERT_EQ(feed.windows.size(), 1);
  feed.withdraw(20, 30);
  EXPECT_FALSE(feed.sampler.open());
  EXPECT_EQ(feed.sampler.ignored(), 11);
  feed.withdraw(70, 72);
  feed.withdraw(70, 72);
  feed.withdraw(-5, -1);
  EXPECT_EQ(feed.sampler.ignored(), 19);
  EXPECT_EQ(feed.sampler.open()->gap_frames, 3);
}

TEST(WindowSampler, APoseForAFrameThatWasThinnedOutCountsToo) {
  Feed feed({.gap_dense_frames = 0});
  feed.span(100, 1, 10);
  feed.motion_px = 0;
  feed.span(10, kNoSubmap);  // one sample
  EXPECT_EQ(feed.sampler.open()->gap.size(), 1);
  for (int64_t utime = 101; utime <= 110; ++utime) feed.late_pose(utime, 2);
  feed.span(1, 2);
  EXPECT_EQ(feed.sampler.open()->gap_frames, 0);
  EXPECT_EQ(feed.sampler.open()->resumed_utime_us, 101);
  EXPECT_THAT(utimes(feed.sampler.open()->departure), ElementsAre(101, 111));
}

}  // namespace
}  // namespace rumi
