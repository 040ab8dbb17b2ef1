// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/window_sampler.h"

#include <gmock/gmock.h>

namespace rumi {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::vector<int64_t> utimes(const std::vector<Sample>& samples) {
  std::vector<int64_t> list;
  for (const Sample& s : samples) list.push_back(s.utime_us);
  return list;
}

std::vector<int64_t> keyframes(const std::vector<Sample>& samples) {
  std::vector<int64_t> list;
  for (const Sample& s : samples)
    if (s.is_keyframe) list.push_back(s.utime_us);
  return list;
}

std::vector<Sample> all_of(const StrideSampler& sampler) {
  return {sampler.samples().begin(), sampler.samples().end()};
}

Sample frame(int64_t utime_us, bool is_keyframe = false) { return {.utime_us = utime_us, .is_keyframe = is_keyframe}; }

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
                                    .has_image = has_image});
      if (ended) windows.push_back(*ended);
    }
  }
  void finish() {
    if (auto ended = sampler.finish("the input ended")) windows.push_back(*ended);
  }
  WindowSampler sampler;
  std::vector<RuminationWindow> windows;
  int64_t now = 0, session = 7;
};

TEST(StrideSampler, TakesEveryStrideth) {
  StrideSampler sampler(5);
  for (int i = 1; i <= 21; ++i) sampler.add(frame(i), true);
  EXPECT_THAT(utimes(all_of(sampler)), ElementsAre(1, 6, 11, 16, 21));
}

TEST(StrideSampler, PrefersKeyframes) {
  StrideSampler sampler(5);
  // 4 is a keyframe half a stride early; 11 comes just after 9 was taken and replaces it; 12 is too near to 11.
  for (int i = 1; i <= 16; ++i) sampler.add(frame(i, i == 4 || i == 11 || i == 12), true);
  EXPECT_THAT(utimes(all_of(sampler)), ElementsAre(1, 4, 11, 16));
  EXPECT_THAT(keyframes(all_of(sampler)), ElementsAre(4, 11));
}

TEST(StrideSampler, StrideOneTakesAllAndFramesWithoutImageNever) {
  StrideSampler sampler(1);
  for (int i = 1; i <= 4; ++i) sampler.add(frame(i, i == 2), i != 3);
  EXPECT_THAT(utimes(all_of(sampler)), ElementsAre(1, 2, 4));
}

TEST(WindowSampler, NothingHappensWithoutALoss) {
  Feed feed;
  feed.span(500, 1, 10);
  feed.span(100, 2, 10);  // from one submap to another without an untracked frame
  feed.finish();
  EXPECT_THAT(feed.windows, IsEmpty());
  EXPECT_FALSE(feed.sampler.open());
  EXPECT_LE(feed.sampler.retained().size(), 11);
}

TEST(WindowSampler, OneLossIsOneWindowOfThreeParts) {
  Feed feed({.stride = 5, .window_length = 4, .departure_min_keyframes = 3});
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

TEST(WindowSampler, LosingAKnownSubmapAgainMakesTwoWindows) {
  Feed feed;
  feed.span(50, 1, 10);
  feed.span(5, kNoSubmap);
  feed.span(20, 1, 0);      // relocalized: 56..75, no new keyframes
  feed.span(5, kNoSubmap);  // 76..80
  feed.span(100, 1, 0);
  ASSERT_EQ(feed.windows.size(), 2);
  EXPECT_EQ(feed.windows[0].submap_after, 1);
  EXPECT_EQ(feed.windows[0].reason, "tracking was lost again");
  EXPECT_THAT(utimes(feed.windows[0].departure), ElementsAre(56, 61, 66, 71));
  EXPECT_EQ(feed.windows[1].id, 2);
  EXPECT_THAT(utimes(feed.windows[1].approach), ElementsAre(56, 61, 66, 71, 75));
  EXPECT_EQ(feed.windows[1].lost_utime_us, 76);
  EXPECT_EQ(feed.windows[1].departure.size(), 10);  // window_length samples are enough
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

TEST(WindowSampler, ALongGapIsThinnedEvenly) {
  Feed feed({.gap_max_frames = 16});
  feed.span(1000, kNoSubmap);
  feed.finish();
  const std::vector<Sample>& gap = feed.windows.at(0).gap;
  ASSERT_LE(gap.size(), 16);
  ASSERT_GE(gap.size(), 8);
  EXPECT_EQ(gap[0].utime_us, 1);
  for (size_t i = 1; i < gap.size(); ++i) EXPECT_EQ(gap[i].utime_us - gap[i - 1].utime_us, 64);
  EXPECT_GT(gap.back().utime_us, 1000 - 64);
}

TEST(WindowSampler, ThinningOnDemandKeepsTheGapEven) {
  Feed feed;
  feed.span(10, kNoSubmap);  // 1..10
  EXPECT_TRUE(feed.sampler.thin_gap());
  feed.span(8, kNoSubmap);
  feed.finish();
  EXPECT_THAT(utimes(feed.windows.at(0).gap), ElementsAre(1, 3, 5, 7, 9, 11, 13, 15, 17));
  EXPECT_FALSE(feed.sampler.thin_gap());
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
  feed.span(30, kNoSubmap);  // 21..50 once more, and not in order
  EXPECT_EQ(feed.sampler.ignored(), 30);
  EXPECT_FALSE(feed.sampler.open());
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
  for (const auto* part : {&feed.sampler.open()->approach, &feed.sampler.open()->gap, &feed.sampler.open()->departure})
    for (const Sample& s : *part) EXPECT_TRUE(retained.contains(s.utime_us)) << s.utime_us;
  for (int64_t utime = 94; utime <= 118; ++utime) EXPECT_TRUE(retained.contains(utime)) << utime;  // may die young
}

}  // namespace
}  // namespace rumi
