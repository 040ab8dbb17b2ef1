// SPDX-License-Identifier: BSD-3-Clause
// Frames that front_tracker reports again: with a late pose, or because it withdraws the pose.
#include "ruminator/window/window_sampler.h"

#include <gmock/gmock.h>

#include <numeric>

#include "tests/ruminator/window_feed.h"

namespace rumi::ruminator {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(WindowSampler, FramesPosedAfterwardsAreDepartureNotGap) {
  WindowFeed feed;
  feed.span(100, 1, 10);
  feed.span(20, kNoSubmap);  // frames 101..120
  for (int64_t utime = 110; utime <= 120; ++utime)
    if (utime != 115) feed.late_pose(utime, 2, utime % 5 == 0);
  feed.span(100, 2, 10);  // frame 121 and later
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
  WindowFeed feed;
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
  WindowFeed feed;
  feed.span(20, kNoSubmap);
  for (int64_t utime = 2; utime <= 20; ++utime) feed.late_pose(utime, 1);
  feed.span(1, 1, 1);
  ASSERT_TRUE(feed.sampler.open());
  EXPECT_TRUE(feed.sampler.is_settled());
  EXPECT_THAT(utimes(feed.sampler.open()->gap), ElementsAre(1));
}

TEST(WindowSampler, WithoutAnyGapTwoSubmapsStillNeedToBeConnected) {
  WindowFeed feed;
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
  WindowFeed feed;
  feed.span(100, 1, 10);
  feed.span(10, kNoSubmap);  // frames 101..110
  for (int64_t utime = 104; utime <= 110; ++utime)
    if (utime != 107) feed.late_pose(utime, 2, utime == 104);
  feed.span(3, 2, 3);  // frames 111..113
  feed.span(2, kNoSubmap);
  ASSERT_TRUE(feed.sampler.open());
  const RuminationWindow& w = *feed.sampler.open();
  EXPECT_EQ(w.gap_frames, 15);
  EXPECT_EQ(utimes(w.gap),
            (std::vector<int64_t>{101, 102, 103, 104, 105, 106, 107, 108, 109, 110, 111, 112, 113, 114, 115}));
  EXPECT_EQ(w.gap[3].submap_id, 2);
  EXPECT_EQ(w.gap[6].submap_id, kNoSubmap);
  EXPECT_EQ(feed.sampler.phase(), WindowSampler::Phase::kGap);
}

TEST(WindowSampler, APoseAfterwardsBeforeAFrameThatHasNoneIsGap) {
  WindowFeed feed({.stride = 5, .window_length = 4, .shared_keyframes = 3, .departure_min_keyframes = 3});
  feed.span(50, 1, 10);
  feed.span(10, kNoSubmap);  // frames 51..60
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
  WindowFeed feed;
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
  WindowFeed feed;
  feed.span(100, 1, 10);
  feed.span(10, kNoSubmap);  // frames 101..110
  feed.late_pose(50, 2);     // the frame had a pose already
  feed.late_pose(105, 2);
  feed.late_pose(105, 2);
  feed.late_pose(106, kNoSubmap);
  EXPECT_EQ(feed.sampler.ignored(), 3);
  feed.span(5, 2, 10);
  feed.late_pose(103, 2);  // too late: a later frame is in the departure already
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

void expect_gap(const RuminationWindow& window, int64_t first, int64_t last) {
  EXPECT_EQ(utimes(window.gap), from_to(first, last));
  EXPECT_EQ(window.gap_frames, last - first + 1);
}

void expect_no_poses(const std::vector<Sample>& samples) {
  for (const Sample& s : samples) EXPECT_TRUE(s.submap_id == kNoSubmap && !s.is_keyframe) << s.utime_us;
}

TEST(WindowSampler, PosesWithdrawnAfterALossAreItsGap) {
  WindowFeed feed({.window_length = 4, .shared_keyframes = 4});
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
  expect_gap(w, 50, 62);
  expect_no_poses(w.gap);
  EXPECT_EQ(feed.sampler.ignored(), 0);
}

TEST(WindowSampler, PosesWithdrawnWithoutALossOpenAWindow) {
  WindowFeed feed({.window_length = 4, .shared_keyframes = 4});
  feed.span(60, 1, 1);
  feed.withdraw(55, 60);
  ASSERT_TRUE(feed.sampler.open());
  EXPECT_EQ(feed.sampler.phase(), WindowSampler::Phase::kGap);
  feed.span(30, 1, 1);
  ASSERT_EQ(feed.windows.size(), 1);
  const RuminationWindow& w = feed.windows[0];
  EXPECT_EQ(w.submap_before, 1);
  EXPECT_EQ(w.submap_after, 1);
  EXPECT_EQ(utimes(w.approach), from_to(51, 54));
  expect_gap(w, 55, 60);
  EXPECT_EQ(feed.sampler.ignored(), 0);
}

TEST(WindowSampler, PosesWithdrawnFromADepartureProlongTheGap) {
  WindowFeed feed({.window_length = 12, .shared_keyframes = 12});
  feed.span(60, 1, 1);
  feed.span(3, kNoSubmap);
  feed.span(9, 1, 1);
  feed.withdraw(66, 72);
  feed.span(30, 1, 1);
  ASSERT_EQ(feed.windows.size(), 1);
  const RuminationWindow& w = feed.windows[0];
  EXPECT_EQ(w.lost_utime_us, 61);
  EXPECT_EQ(w.resumed_utime_us, 73);
  expect_gap(w, 61, 72);
  EXPECT_EQ(w.gap[4].submap_id, 1) << "of the departure, and not withdrawn";
  expect_no_poses({w.gap.begin() + 5, w.gap.end()});
}

TEST(WindowSampler, WithdrawnFramesThatAreNoSamplesCount) {
  WindowFeed feed({.stride = 5, .window_length = 4, .shared_keyframes = 4});
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
  WindowFeed feed({.window_length = 4, .shared_keyframes = 4});
  feed.span(30, 1, 1);
  feed.span(2, kNoSubmap);
  feed.span(40, 2, 1);  // this completes the window
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
  WindowFeed feed({.gap_max_frames = 1});
  feed.span(100, 1, 10);
  feed.motion_px = 0;
  feed.span(10, kNoSubmap);  // the gap keeps one sample
  EXPECT_EQ(feed.sampler.open()->gap.size(), 1);
  for (int64_t utime = 101; utime <= 110; ++utime) feed.late_pose(utime, 2);
  feed.span(1, 2);
  EXPECT_EQ(feed.sampler.open()->gap_frames, 0);
  EXPECT_EQ(feed.sampler.open()->resumed_utime_us, 101);
  EXPECT_THAT(utimes(feed.sampler.open()->departure), ElementsAre(101, 111));
}

}  // namespace
}  // namespace rumi::ruminator
