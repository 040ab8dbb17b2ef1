// SPDX-License-Identifier: BSD-3-Clause
#include "camera_driver/recording/frame_order.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <numeric>
#include <random>

namespace rumi::camera_driver {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr int64_t kPeriodUs = 33'333;

std::vector<int64_t> even_times(int count, int64_t first_us = 1'400'000'000'000'000) {
  std::vector<int64_t> times;
  for (int i = 0; i < count; ++i) times.push_back(first_us + i * kPeriodUs);
  return times;
}

std::vector<size_t> numbers(const FrameOrder& order) {
  std::vector<size_t> all;
  for (const OrderedFrame& frame : order.frames) all.push_back(frame.frame);
  return all;
}

std::vector<size_t> all_but(size_t count, const std::vector<size_t>& left_out) {
  std::vector<size_t> all;
  for (size_t i = 0; i < count; ++i)
    if (std::find(left_out.begin(), left_out.end(), i) == left_out.end()) all.push_back(i);
  return all;
}

void expect_rising(const FrameOrder& order) {
  for (size_t i = 1; i < order.frames.size(); ++i) {
    const OrderedFrame &before = order.frames[i - 1], &frame = order.frames[i];
    EXPECT_GT(frame.elapsed_us, before.elapsed_us) << i;
    if (frame.part == before.part)
      EXPECT_GT(frame.utime_us, before.utime_us) << i;
    else
      EXPECT_EQ(frame.part, before.part + 1) << i;
  }
}

TEST(FrameOrder, RisingTimesStayAsTheyAre) {
  std::vector<int64_t> times = even_times(50);
  for (size_t i = 30; i < times.size(); ++i) times[i] += 3'600'000'000;  // a pause, or the clock was set forward
  const FrameOrder order = order_frames(times).value();
  EXPECT_EQ(numbers(order), all_but(50, {}));
  EXPECT_FALSE(order.is_sorted);
  EXPECT_EQ(order.frames.back().part, 0);
  EXPECT_EQ(order.frames.back().elapsed_us, times.back() - times.front());
  EXPECT_THAT(order_frames({}).value().frames, IsEmpty());
  EXPECT_EQ(order_frames({7}).value().frames.size(), 1u);
}

TEST(FrameOrder, AWrongTimeIsLeftOutAndNothingElse) {
  for (const int64_t wrong_us :
       {int64_t{0}, int64_t{1'000'000'000}, int64_t{1'400'001'000'000'000}, int64_t{1} << 60}) {
    for (const std::vector<size_t>& wrong : {std::vector<size_t>{1}, {30}, {30, 31}, {5, 40, 80}}) {
      std::vector<int64_t> times = even_times(100);
      for (const size_t i : wrong) times[i] = wrong_us + static_cast<int64_t>(i);
      const FrameOrder order = order_frames(times).value();
      EXPECT_EQ(order.wrong_times, wrong) << wrong_us;
      EXPECT_EQ(numbers(order), all_but(100, wrong)) << wrong_us;
      expect_rising(order);
    }
  }
}

TEST(FrameOrder, TheFirstTimeMayBeWrong) {
  std::vector<int64_t> times = even_times(50);
  times[0] += 1'000'000'000;
  EXPECT_EQ(order_frames(times).value().wrong_times, std::vector<size_t>{0});
}

TEST(FrameOrder, AFewTimesFarAwayAtAnEndAreWrong) {
  for (const size_t few : {size_t{1}, size_t{3}}) {
    std::vector<int64_t> first = even_times(100), last = even_times(100);
    for (size_t i = 0; i < few; ++i) first[i] = static_cast<int64_t>(i);
    for (size_t i = 0; i < few; ++i) last[99 - i] += 1'000'000'000'000;
    EXPECT_EQ(order_frames(first).value().wrong_times.size(), few);
    EXPECT_EQ(order_frames(first).value().frames.front().frame, few);
    EXPECT_EQ(order_frames(last).value().wrong_times.size(), few);
    EXPECT_EQ(order_frames(last).value().frames.size(), 100 - few);
  }
  std::vector<int64_t> pause = even_times(100);
  for (size_t i = 2; i < 100; ++i) pause[i] += 20'000'000;
  EXPECT_TRUE(order_frames(pause).value().wrong_times.empty()) << "the camera was held up for 20 s";
}

TEST(FrameOrder, FramesStoredALittleTooEarlyOrTooLateArePutInTheirPlace) {
  std::vector<int64_t> times = even_times(60);
  std::swap(times[20], times[21]);
  std::rotate(times.begin() + 40, times.begin() + 41, times.begin() + 44);
  const FrameOrder order = order_frames(times).value();
  EXPECT_TRUE(order.is_sorted);
  EXPECT_EQ(order.frames.size(), 60u);
  EXPECT_EQ(order.frames.back().part, 0);
  expect_rising(order);
}

TEST(FrameOrder, DisorderIsSorted) {
  std::mt19937 random(5);
  for (const size_t block : {size_t{9}, size_t{90}}) {
    std::vector<int64_t> times = even_times(90);
    for (size_t i = 0; i < times.size(); i += block)
      std::shuffle(times.begin() + static_cast<std::ptrdiff_t>(i),
                   times.begin() + static_cast<std::ptrdiff_t>(i + block), random);
    const FrameOrder order = order_frames(times).value();
    EXPECT_TRUE(order.is_sorted);
    EXPECT_EQ(order.frames.size(), 90u);
    expect_rising(order);
  }
  std::vector<int64_t> backwards = even_times(40);
  std::reverse(backwards.begin(), backwards.end());
  EXPECT_EQ(numbers(order_frames(backwards).value()).front(), 39u);
}

TEST(FrameOrder, AClockThatIsSetBackBeginsANewPart) {
  for (const int64_t back_us : {int64_t{1'000'000}, int64_t{3'600'000'000}}) {
    std::vector<int64_t> times = even_times(120);
    for (size_t i = 60; i < times.size(); ++i) times[i] -= back_us;
    const FrameOrder order = order_frames(times).value();
    EXPECT_EQ(numbers(order), all_but(120, {})) << "in the order in which they were taken";
    EXPECT_EQ(order.frames[59].part, 0);
    EXPECT_EQ(order.frames[60].part, 1);
    EXPECT_EQ(order.frames[60].utime_us, times[60]);
    EXPECT_EQ(order.frames[60].elapsed_us, 60 * kPeriodUs);
    expect_rising(order);
  }
}

TEST(FrameOrder, BlocksOfAListInDisorderAreOneRecording) {
  std::vector<int64_t> times = even_times(200);
  std::rotate(times.begin(), times.begin() + 100, times.end());
  std::rotate(times.begin(), times.begin() + 50, times.begin() + 100);
  std::rotate(times.begin() + 100, times.begin() + 150, times.end());
  const FrameOrder order = order_frames(times).value();
  EXPECT_EQ(order.frames.size(), 200u);
  EXPECT_EQ(order.frames.back().part, 0);
  EXPECT_TRUE(order.is_sorted);
  expect_rising(order);
}

TEST(FrameOrder, DuplicatesAreLeftOutAndTooManyAreAnError) {
  std::vector<int64_t> times = even_times(50);
  times[10] = times[9];
  times[30] = times[29];
  EXPECT_THAT(order_frames(times).value().duplicates, ElementsAre(10, 30));
  EXPECT_EQ(order_frames(times).value().frames.size(), 48u);
  EXPECT_THAT(order_frames(std::vector<int64_t>(90, 0)).error_text(), HasSubstr("--rate HZ"));
  for (size_t i = 0; i < times.size(); ++i) times[i] = 1'000'000 * static_cast<int64_t>(i / 30);  // whole seconds
  EXPECT_THAT(order_frames(times).error_text(), HasSubstr("of its 50 images 48 have the time of another one"));
}

// Whatever the times are, each frame is handed out once, or left out for one reason.
TEST(FrameOrder, NoFrameIsLostOrDoubled) {
  std::mt19937 random(1);
  for (int round = 0; round < 2000; ++round) {
    std::vector<int64_t> times = even_times(2 + static_cast<int>(random() % 60), 0);
    const int changes = static_cast<int>(random() % 12);
    for (int i = 0; i < changes; ++i) {
      int64_t& time = times[random() % times.size()];
      switch (random() % 4) {
        case 0:
          time = times[random() % times.size()];
          break;
        case 1:
          time += static_cast<int64_t>(random() % 10'000'000);
          break;
        case 2:
          time = static_cast<int64_t>(random() % 100);
          break;
        default:
          std::rotate(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(random() % times.size()), times.end());
      }
    }
    const Result<FrameOrder> ordered = order_frames(times);
    if (!ordered) continue;
    const FrameOrder& order = *ordered;
    std::vector<size_t> all = numbers(order);
    all.insert(all.end(), order.duplicates.begin(), order.duplicates.end());
    all.insert(all.end(), order.wrong_times.begin(), order.wrong_times.end());
    std::sort(all.begin(), all.end());
    EXPECT_EQ(all, all_but(times.size(), {})) << round;
    expect_rising(order);
  }
}

TEST(FrameOrder, AtARate) {
  const FrameOrder order = frames_at_rate(4, 30, 5'000'000);
  EXPECT_EQ(numbers(order), all_but(4, {}));
  EXPECT_EQ(order.frames[3].utime_us, 5'100'000);
  EXPECT_EQ(order.frames[3].elapsed_us, 100'000);
}

// Times may come from the camera's clock and the computer's in turn. Either may be ahead, or be used a little more
// often.
TEST(FrameOrder, TwoClocksInTurnAreRefused) {
  for (const int64_t offset_us :
       {-1'400'000'000'000'000ll, -20'000'000ll, -1'000'000ll, 1'000'000ll, 3'600'000'000ll}) {
    std::vector<int64_t> times = even_times(200);
    for (size_t i = 0; i < times.size(); ++i)
      if (i % 2 == 1 || i % 7 == 0) times[i] += offset_us;
    EXPECT_THAT(order_frames(times).error_text(), HasSubstr("two clocks in turn")) << offset_us;
  }
}

TEST(FrameOrder, ImagesSwappedInPairsAreNoTwoClocks) {
  std::vector<int64_t> times = even_times(200);
  for (size_t i = 0; i + 1 < times.size(); i += 2) std::swap(times[i], times[i + 1]);
  const FrameOrder order = order_frames(times).value();
  EXPECT_EQ(order.frames.size(), 200u);
}

}  // namespace
}  // namespace rumi::camera_driver
