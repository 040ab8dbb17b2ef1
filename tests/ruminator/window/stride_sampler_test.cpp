// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/window/stride_sampler.h"

#include <gmock/gmock.h>

namespace rumi::ruminator {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::vector<int64_t> utimes(const StrideSampler& sampler) {
  std::vector<int64_t> list;
  for (const Sample& s : sampler.samples()) list.push_back(s.utime_us);
  return list;
}

Sample frame(int64_t utime_us, bool is_keyframe = false, double turn_deg = 0) {
  const Eigen::AngleAxisd turn(turn_deg * std::numbers::pi / 180.0, Eigen::Vector3d::UnitY());
  return {.utime_us = utime_us,
          .is_keyframe = is_keyframe,
          .submap_id = 1,
          .cam_from_submap = {Eigen::Quaterniond(turn), Eigen::Vector3d(1, 2, 3)}};
}

TEST(StrideSampler, TakesAFramePerStride) {
  StrideSampler sampler(5);
  for (int i = 1; i <= 21; ++i) sampler.add(frame(i), true);
  EXPECT_THAT(utimes(sampler), ElementsAre(1, 6, 11, 16, 21));
}

TEST(StrideSampler, TakesEveryKeyframe) {
  StrideSampler sampler(5);
  // Keyframes 4 and 12 are sampled before the stride ends; 11 comes shortly after sample 9 and replaces it.
  for (int i = 1; i <= 17; ++i) sampler.add(frame(i, i == 4 || i == 11 || i == 12), true);
  EXPECT_THAT(utimes(sampler), ElementsAre(1, 4, 11, 12, 17));
  EXPECT_EQ(sampler.keyframes(), 3);
}

TEST(StrideSampler, TakesAFramePerTurn) {
  StrideSampler sampler(5);
  for (int i = 0; i < 8; ++i) sampler.add(frame(i, false, 16.6 * i), true);  // a fast turn, filmed at 5 Hz
  EXPECT_EQ(sampler.samples().size(), 8);
  sampler.clear();
  for (int i = 0; i < 9; ++i) sampler.add(frame(i, false, 1.5 * i), true);
  EXPECT_THAT(utimes(sampler), ElementsAre(0, 4, 8));
}

TEST(StrideSampler, AKeyframeDoesNotReplaceABridge) {
  StrideSampler sampler(5);
  sampler.add(frame(1, true, 0), true);
  sampler.add(frame(2, false, 11), true);
  sampler.add(frame(3, true, 12), true);
  EXPECT_THAT(utimes(sampler), ElementsAre(1, 2, 3));
}

TEST(StrideSampler, AKeyframeDoesNotReplaceTheFirst) {
  StrideSampler sampler(5);
  sampler.add(frame(1), true);
  sampler.add(frame(2, true), true);
  EXPECT_THAT(utimes(sampler), ElementsAre(1, 2));
}

TEST(StrideSampler, StrideOneTakesAllAndFramesWithoutImageNever) {
  StrideSampler sampler(1);
  for (int i = 1; i <= 4; ++i) sampler.add(frame(i, i == 2), i != 3);
  EXPECT_THAT(utimes(sampler), ElementsAre(1, 2, 4));
}

TEST(StrideSampler, KeepsTheNewestAndOlderKeyframes) {
  StrideSampler sampler(2);
  for (int i = 0; i <= 40; ++i) sampler.add(frame(i, i % 8 == 0), true);
  sampler.keep_newest(4, 3);
  EXPECT_THAT(utimes(sampler), ElementsAre(24, 32, 34, 36, 38, 40));
  sampler.keep_newest(2, 0);
  EXPECT_THAT(utimes(sampler), ElementsAre(38, 40));
  sampler.keep_newest(0, 0);
  EXPECT_THAT(utimes(sampler), IsEmpty());
}

TEST(StrideSampler, TheLastFrameIsAddedOnce) {
  StrideSampler sampler(5);
  sampler.add_last(frame(1));
  for (int i = 2; i <= 4; ++i) sampler.add(frame(i), true);
  sampler.add_last(frame(4));
  sampler.add_last(frame(4));
  EXPECT_THAT(utimes(sampler), ElementsAre(1, 4));
}

}  // namespace
}  // namespace rumi::ruminator
