// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/window/gap_thinner.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <limits>

namespace rumi::ruminator {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::vector<int64_t> utimes(const GapThinner& thinner) {
  std::vector<int64_t> list;
  for (const Sample& sample : thinner.samples()) list.push_back(sample.utime_us);
  return list;
}

std::vector<double> steps(const GapThinner& thinner) {
  std::vector<double> list;
  for (size_t i = 1; i < thinner.frames().size(); ++i)
    list.push_back(thinner.frames()[i].path_px - thinner.frames()[i - 1].path_px);
  return list;
}

GapFrame frame(int64_t utime_us, double path_px, double sharpness = 1) {
  return {.sample = {.utime_us = utime_us}, .path_px = path_px, .sharpness = sharpness};
}

TEST(GapThinner, KeepsEveryFrameBelowTheCap) {
  GapThinner thinner(50);
  for (int i = 0; i < 50; ++i) thinner.add(frame(i, 4.0 * i, i % 2 ? 1 : 0.01));
  EXPECT_EQ(thinner.frames().size(), 50);
}

TEST(GapThinner, LeavesOutFramesThatHardlyMovedOnceThereAreMany) {
  GapThinner many(5);
  for (int i = 0; i < 20; ++i) many.add(frame(i, 3));
  EXPECT_THAT(utimes(many), ElementsAre(0, 1, 2, 3, 4));
  GapThinner thinner(3);
  for (const double path_px : {0.0, 10.0, 20.0, 21.0, 21.5, 22.9}) thinner.add(frame(1, path_px));
  EXPECT_THAT(steps(thinner), ElementsAre(10, 11.5)) << "20 went for 21.5";
}

TEST(GapThinner, ThinsEvenlyInMotionNotInTime) {
  GapThinner thinner(20);
  double path_px = 0;
  int64_t utime = 0;
  for (int i = 0; i < 100; ++i) thinner.add(frame(++utime, path_px += 2));  // the camera hovers
  for (int i = 0; i < 10; ++i) thinner.add(frame(++utime, path_px += 40));  // the camera turns fast
  for (int i = 0; i < 100; ++i) thinner.add(frame(++utime, path_px += 2));
  EXPECT_EQ(thinner.frames().size(), 20);
  EXPECT_EQ(thinner.frames().front().sample.utime_us, 1);
  EXPECT_EQ(thinner.frames().back().sample.utime_us, 210);
  const auto times = utimes(thinner);
  const auto in_turn = std::count_if(times.begin(), times.end(), [](int64_t t) { return t > 100 && t <= 110; });
  EXPECT_GE(in_turn, 8) << "half of the motion is in a twentieth of the time";
}

TEST(GapThinner, UniformMotionStaysEven) {
  GapThinner thinner(16);
  for (int i = 0; i < 1000; ++i) thinner.add(frame(i, 12.0 * i));
  const std::vector<double> list = steps(thinner);
  ASSERT_EQ(list.size(), 15);
  EXPECT_LE(*std::max_element(list.begin(), list.end()), 12.0 * 128);  // 64 steps would be ideal
}

TEST(GapThinner, BlurredFramesGoFirst) {
  GapThinner thinner(15);
  for (int i = 0; i < 20; ++i)
    thinner.add(frame(i, 10.0 * i, i == 3 || i == 7 || i == 8 || i == 12 || i == 17 ? 0.2 : 1));
  EXPECT_THAT(utimes(thinner), ElementsAre(0, 1, 2, 4, 5, 6, 9, 10, 11, 13, 14, 15, 16, 18, 19));
}

TEST(GapThinner, ABlurredFrameStaysWhereItHoldsTheChainTogether) {
  GapThinner thinner(6);
  // The frame at 36 px is blurred, but stays: without it its neighbours would be 40 px apart, more than the 36 px
  // allowed.
  const double path_px[] = {0, 8, 16, 36, 56, 64, 72};
  for (int i = 0; i < 7; ++i) thinner.add(frame(i, path_px[i], i == 3 ? 0.1 : 1));
  EXPECT_THAT(utimes(thinner), ElementsAre(0, 2, 3, 4, 5, 6));
}

TEST(GapThinner, BlurIsRelativeToTheNeighbours) {
  // The scene becomes poor in texture: later frames are less sharp than the first ones, but none is blurred.
  GapThinner thinner(29);
  for (int i = 0; i < 30; ++i) thinner.add(frame(i, i == 20 ? 10.0 * i + 9 : 10.0 * i, i < 15 ? 1 : 0.1));
  EXPECT_THAT(utimes(thinner), ::testing::Contains(15));
  EXPECT_THAT(utimes(thinner), ::testing::Contains(16));
}

// Frames with withdrawn poses were not measured.
TEST(GapThinner, FramesOfUnknownSharpnessMakeNoOthersBlurred) {
  constexpr double kUnknown = std::numeric_limits<double>::infinity();
  GapThinner thinner(8);
  std::vector<GapFrame> frames;
  for (int i = 0; i < 4; ++i) frames.push_back(frame(i, 10.0 * i, kUnknown));
  frames.push_back(frame(4, 40, 1));
  for (int i = 5; i < 8; ++i) frames.push_back(frame(i, 10.0 * i, kUnknown));
  thinner.merge(frames);
  thinner.add(frame(8, 72, 1));  // the frame before it moves least
  EXPECT_THAT(utimes(thinner), ElementsAre(0, 1, 2, 3, 4, 5, 6, 8));
}

TEST(GapThinner, BlackFramesAmongBlackOnesAreThinnedLikeOthers) {
  GapThinner thinner(10);
  for (int i = 0; i < 500; ++i) thinner.add(frame(i, 12.0 * i, 0));
  EXPECT_EQ(thinner.frames().size(), 10);
}

TEST(GapThinner, HalvesAndStaysAtHalf) {
  GapThinner thinner(100);
  EXPECT_FALSE(thinner.halve());
  for (int i = 0; i < 9; ++i) thinner.add(frame(i, 5.0 * i));
  EXPECT_TRUE(thinner.halve());
  EXPECT_EQ(thinner.frames().size(), 5);
  for (int i = 9; i < 30; ++i) thinner.add(frame(i, 5.0 * i));
  EXPECT_EQ(thinner.frames().size(), 5);
  EXPECT_TRUE(thinner.halve());
  EXPECT_TRUE(thinner.halve());
  EXPECT_THAT(utimes(thinner), ElementsAre(0, 29));
  EXPECT_FALSE(thinner.halve());
}

TEST(GapThinner, TakesOutAndMergesByTime) {
  GapThinner thinner(6);
  for (int i : {1, 2, 5, 6}) thinner.add(frame(i, 10.0 * i));
  EXPECT_FALSE(thinner.take(3));
  ASSERT_TRUE(thinner.take(5));
  EXPECT_FALSE(thinner.take(5));
  thinner.merge({frame(3, 30), frame(4, 40), frame(7, 70)});
  EXPECT_THAT(utimes(thinner), ElementsAre(1, 2, 3, 4, 6, 7));
  thinner.merge({frame(8, 80), frame(9, 90)});
  EXPECT_EQ(thinner.frames().size(), 6);
  thinner.merge({});
  EXPECT_EQ(utimes(thinner).back(), 9);
}

TEST(GapThinner, ACapOfTwoKeepsTheEnds) {
  GapThinner thinner(2);
  for (int i = 0; i < 10; ++i) thinner.add(frame(i, 5.0 * i));
  EXPECT_THAT(utimes(thinner), ElementsAre(0, 9));
}

}  // namespace
}  // namespace rumi::ruminator
