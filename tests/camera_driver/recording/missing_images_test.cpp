// SPDX-License-Identifier: BSD-3-Clause
#include "camera_driver/recording/missing_images.h"

#include <gtest/gtest.h>

#include <functional>
#include <random>

namespace rumi::camera_driver {
namespace {

constexpr int64_t kPeriodUs = 33'333;

// Returns those of 300 images for which `is_there` is true, at 30 Hz with a jitter of 2 ms.
std::vector<OrderedFrame> frames(const std::function<bool(int)>& is_there) {
  std::mt19937 rng(1);
  std::uniform_int_distribution<int64_t> jitter(-2000, 2000);
  std::vector<OrderedFrame> all;
  for (int i = 0; i < 300; ++i) {
    const int64_t utime_us = 1'000'000 + i * kPeriodUs + jitter(rng);
    if (is_there(i)) all.push_back({static_cast<size_t>(i), utime_us, utime_us, 0});
  }
  return all;
}

TEST(MissingImages, AreNoneOfAWholeRecording) {
  EXPECT_EQ(find_missing_images(frames([](int) { return true; })).count, 0);
  EXPECT_EQ(find_missing_images({}).count, 0);
  EXPECT_EQ(find_missing_images(frames([](int i) { return i == 0; })).count, 0);
}

TEST(MissingImages, AreCounted) {
  const MissingImages every_fifth = find_missing_images(frames([](int i) { return i % 5 != 2; }));
  EXPECT_EQ(every_fifth.count, 60);
  EXPECT_NEAR(static_cast<double>(every_fifth.period_us), kPeriodUs, 1000);
  EXPECT_EQ(find_missing_images(frames([](int i) { return i < 100 || i > 103; })).count, 4);
}

TEST(MissingImages, OfAPauseAreNone) {
  EXPECT_EQ(find_missing_images(frames([](int i) { return i < 100 || i > 180; })).count, 0);
}

TEST(MissingImages, AreNoneWhereTheClockWasSetBack) {
  std::vector<OrderedFrame> two = frames([](int) { return true; });
  for (OrderedFrame frame : frames([](int) { return true; })) {
    frame.part = 1;
    frame.utime_us += 3 * kPeriodUs;
    two.push_back(frame);
  }
  EXPECT_EQ(find_missing_images(two).count, 0);
}

TEST(MissingImages, AreNotToldOfStepsOfAnyLength) {
  std::mt19937 rng(2);
  std::uniform_int_distribution<int64_t> step_us(10'000, 300'000);
  std::vector<OrderedFrame> any;
  for (int64_t i = 0, utime_us = 0; i < 300; ++i, utime_us += step_us(rng)) any.push_back({0, utime_us, utime_us, 0});
  EXPECT_EQ(find_missing_images(any).count, 0);
}

}  // namespace
}  // namespace rumi::camera_driver
