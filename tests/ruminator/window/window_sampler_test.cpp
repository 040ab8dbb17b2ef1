// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/window/window_sampler.h"

#include <gmock/gmock.h>

#include "tests/ruminator/window_feed.h"

namespace rumi::ruminator {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(WindowSampler, NothingHappensWithoutALoss) {
  WindowFeed feed;
  feed.span(500, 1, 10);
  feed.span(100, 2, 10);  // goes over to another submap without an untracked frame
  feed.finish();
  EXPECT_THAT(feed.windows, IsEmpty());
  EXPECT_FALSE(feed.sampler.open());
  WindowFeed stays;
  stays.span(600, 1, 10);
  EXPECT_EQ(feed.sampler.retained(), stays.sampler.retained()) << "of the approach, with what may yet be withdrawn";
}

TEST(WindowSampler, OneLossIsOneWindowOfThreeParts) {
  WindowFeed feed({.stride = 5, .window_length = 4, .shared_keyframes = 3, .departure_min_keyframes = 3});
  feed.span(103, 1);  // frames 1..103: samples at 1, 6, ..., 101
  feed.span(7, kNoSubmap);
  ASSERT_TRUE(feed.sampler.open());
  EXPECT_EQ(feed.sampler.phase(), WindowSampler::Phase::kGap);
  feed.span(30, 2, 10);  // frames from 111 on, keyframes at 111, 121, 131
  ASSERT_EQ(feed.windows.size(), 1);
  const RuminationWindow& w = feed.windows[0];
  EXPECT_EQ(w.id, 1);
  EXPECT_EQ(w.session, 7);
  EXPECT_EQ(w.submap_before, 1);
  EXPECT_EQ(w.submap_after, 2);
  EXPECT_EQ(w.lost_utime_us, 104);
  EXPECT_EQ(w.resumed_utime_us, 111);
  EXPECT_THAT(utimes(w.approach), ElementsAre(91, 96, 101, 103));  // the last tracked frame is always included
  EXPECT_THAT(utimes(w.gap), ElementsAre(104, 105, 106, 107, 108, 109, 110));
  EXPECT_THAT(utimes(w.departure), ElementsAre(111, 116, 121, 126, 131));
  EXPECT_TRUE(w.departure[0].is_keyframe && w.departure[2].is_keyframe);
  EXPECT_EQ(w.reason, "");
  EXPECT_FALSE(feed.sampler.open());
}

TEST(WindowSampler, ALossBeforeTheFirstSubmapHasNoApproach) {
  WindowFeed feed;
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
  WindowFeed feed;
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
  WindowFeed feed;
  feed.span(50, 1, 10);
  feed.span(5, kNoSubmap);  // frames 51..55
  feed.span(12, 2, 5);      // frames 56..67 with three keyframes
  feed.span(4, kNoSubmap);  // frames 68..71
  feed.span(100, 3, 5);     // frames from 72 on
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
  WindowFeed feed;
  feed.span(50, 1, 10);
  feed.span(5, kNoSubmap);  // frames 51..55
  feed.span(12, 2, 5);      // frames 56..67: the submap dies young
  feed.span(4, kNoSubmap);  // frames 68..71
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
  WindowFeed feed;
  feed.span(50, 1, 10);
  feed.span(5, kNoSubmap);  // frames 51..55
  feed.span(20, 1, 0);      // relocalized: frames 56..75, no new keyframes, four samples
  feed.span(5, kNoSubmap);  // frames 76..80
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
  WindowFeed feed({.window_length = 10});
  feed.span(50, 1, 10);
  feed.span(5, kNoSubmap);
  feed.span(60, 2, 4);
  feed.span(5, kNoSubmap);
  feed.span(60, 1, 0);  // relocalized: frames 121..180, too few keyframes to be complete, but enough samples
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
  WindowFeed feed;
  feed.span(5, kNoSubmap);
  feed.span(1000, 1, 0);
  ASSERT_EQ(feed.windows.size(), 1);
  EXPECT_EQ(feed.windows[0].departure.size(), 40);
}

TEST(WindowSampler, ChangingSubmapDuringDepartureEndsTheWindow) {
  WindowFeed feed;
  feed.span(50, 1, 10);
  feed.span(5, kNoSubmap);
  feed.span(12, 2, 5);
  feed.span(50, 1, 0);
  ASSERT_EQ(feed.windows.size(), 1);
  EXPECT_EQ(feed.windows[0].submap_after, 2);
  EXPECT_THAT(feed.windows[0].reason, HasSubstr("submap 1"));
}

// A new submap without a loss before it goes on from the last one, whose samples are its own.
TEST(WindowSampler, ASubmapThatGoesOnFromAnotherHasItsSamples) {
  const WindowOptions options{.stride = 5, .window_length = 4, .shared_keyframes = 3, .departure_min_keyframes = 3};
  WindowFeed feed(options);
  feed.span(103, 1);
  feed.span(3, 2, 10);
  feed.span(7, kNoSubmap);
  feed.span(12, 3, 10);
  feed.span(30, 4, 10);
  ASSERT_EQ(feed.windows.size(), 1) << "no window of its own";
  const RuminationWindow& w = feed.windows[0];
  EXPECT_THAT(utimes(w.approach), ElementsAre(96, 101, 104, 106));
  EXPECT_EQ(w.submap_before, 2);
  for (const Sample& sample : w.approach) EXPECT_EQ(sample.submap_id, 2);
  EXPECT_EQ(w.reason, "");
  EXPECT_EQ(w.submap_after, 4);
  for (const Sample& sample : w.departure) EXPECT_EQ(sample.submap_id, 4);
}

TEST(WindowSampler, ALongGapIsThinnedButCountedInFull) {
  WindowFeed feed({.gap_max_frames = 16});
  feed.span(1000, kNoSubmap);
  feed.finish();
  const RuminationWindow& w = feed.windows.at(0);
  EXPECT_EQ(w.gap.size(), 16);
  EXPECT_EQ(w.gap_frames, 1000);
  EXPECT_EQ(w.gap.front().utime_us, 1);
  EXPECT_EQ(w.gap.back().utime_us, 1000);
}

TEST(WindowSampler, ThinningOnDemandLastsForTheWindow) {
  WindowFeed feed;
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
  WindowFeed feed({.gap_max_frames = 20});
  feed.span(50, 1, 10);
  feed.span(15, kNoSubmap);  // frames 51..65
  feed.span(15, 2, 5);       // frames 66..80
  feed.span(1, kNoSubmap);
  ASSERT_TRUE(feed.sampler.open());
  EXPECT_EQ(feed.sampler.open()->gap.size(), 20);
  EXPECT_EQ(feed.sampler.open()->gap_frames, 31);
  EXPECT_LE(feed.sampler.retained().size(), 20 + 11);
}

TEST(WindowSampler, ACameraThatHardlyMovesLeavesFewSamples) {
  WindowFeed feed({.gap_max_frames = 10});
  feed.motion_px = 0.5;
  feed.span(41, kNoSubmap);
  feed.finish();
  EXPECT_EQ(feed.windows.at(0).gap.size(), 10);
  EXPECT_EQ(feed.windows[0].gap.back().utime_us, 40) << "every third frame after the tenth";
}

TEST(WindowSampler, FramesWithoutImageCountForTheStateOnly) {
  WindowFeed feed;
  feed.span(50, 1, 10);
  feed.span(3, kNoSubmap, 0, false);  // frames 51..53
  feed.span(3, kNoSubmap);
  feed.span(1, 2, 1, false);  // frame 57, at which tracking resumes
  feed.span(100, 2, 4);
  ASSERT_EQ(feed.windows.size(), 1);
  EXPECT_EQ(feed.windows[0].lost_utime_us, 51);
  EXPECT_EQ(feed.windows[0].resumed_utime_us, 57);
  EXPECT_THAT(utimes(feed.windows[0].gap), ElementsAre(54, 55, 56));
  EXPECT_EQ(feed.windows[0].departure.front().utime_us, 58);
}

TEST(WindowSampler, RepeatedAndLateFramesAreIgnored) {
  WindowFeed feed;
  feed.span(50, 1, 10);
  feed.now = 20;
  feed.span(30, 1);  // frames 21..50 again, out of order
  EXPECT_EQ(feed.sampler.ignored(), 30);
  EXPECT_FALSE(feed.sampler.open());
  feed.span(5, kNoSubmap);
  feed.withdraw(51, 55);  // these frames had no pose
  EXPECT_EQ(feed.sampler.ignored(), 35);
  EXPECT_EQ(feed.sampler.open()->gap_frames, 5);
}

TEST(WindowSampler, ANewSessionStartsAfresh) {
  WindowFeed feed;
  feed.span(50, 1, 10);
  feed.span(5, kNoSubmap);
  feed.session = 8;
  feed.now = 0;  // although its time begins anew
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
  WindowFeed feed;
  feed.span(73, 1, 7);
  feed.span(20, kNoSubmap);
  feed.span(25, 2, 6);
  const std::set<int64_t> retained = feed.sampler.retained();
  ASSERT_TRUE(feed.sampler.open());
  for (const Sample& s : feed.sampler.open()->samples()) EXPECT_TRUE(retained.contains(s.utime_us)) << s.utime_us;
  for (int64_t utime = 94; utime <= 118; ++utime) EXPECT_TRUE(retained.contains(utime)) << utime;  // it may die young
}

TEST(WindowSampler, TenKeyframesAreSharedOnEachSideWhereThereAreSoMany) {
  WindowFeed feed;
  feed.span(400, 1, 12);  // keyframes at 1, 13, ..., 397
  feed.span(10, kNoSubmap);
  feed.span(400, 2, 12);
  ASSERT_EQ(feed.windows.size(), 1);
  const RuminationWindow& w = feed.windows[0];
  EXPECT_THAT(keyframes(w.approach), ElementsAre(289, 301, 313, 325, 337, 349, 361, 373, 385, 397));
  EXPECT_EQ(w.approach.back().utime_us, 400);
  EXPECT_LE(w.approach.size(), 20);
  EXPECT_EQ(keyframes(w.departure).size(), 10);
  EXPECT_EQ(w.departure.back().utime_us, 411 + 9 * 12);  // the time of the tenth keyframe
}

TEST(WindowSampler, AShortSubmapSharesWhatItHas) {
  WindowFeed feed;
  feed.span(5, kNoSubmap);
  feed.span(90, 1, 10);  // nine keyframes
  feed.span(5, kNoSubmap);
  ASSERT_TRUE(feed.sampler.open());
  EXPECT_EQ(keyframes(feed.sampler.open()->approach).size(), 9);
}

TEST(WindowSampler, LostBetweenEnoughAndManyKeyframesTheWindowIsComplete) {
  WindowFeed feed({.shared_keyframes = 10, .departure_min_keyframes = 8});
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
  feed.span(28, 3, 4);  // seven keyframes: it died young
  feed.span(5, kNoSubmap);
  EXPECT_EQ(feed.windows.size(), 1);
  EXPECT_EQ(feed.sampler.open()->gap_frames, 38);
}

TEST(WindowSampler, RelocalizationInAnotherKnownSubmapWaitsForKeyframesToShare) {
  WindowFeed feed;
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

}  // namespace
}  // namespace rumi::ruminator
