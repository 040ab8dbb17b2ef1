// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/image_times.h"

#include <gmock/gmock.h>

#include <vector>

namespace rumi::front_tracker {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Verdict = ImageTimes::Verdict;
using Doubt = ImageTimes::Doubt;

constexpr int64_t kNow_us = 1'700'000'000'000'000, kPeriod_us = 33'333, kHour_us = 3'600'000'000;

// Images come at 30 Hz. Once a row of waiting images is decided, they are judged again and taken, as front_tracker
// does.
class ImageTimesTest : public ::testing::Test {
 protected:
  Verdict come(int64_t utime_us, bool is_checked = false) {
    const int64_t now_us = kNow_us + kPeriod_us * come_++;
    const Verdict verdict = times_.judge(utime_us, now_us, is_checked);
    if (verdict == Verdict::kNext) times_.take(utime_us, now_us);
    if (verdict == Verdict::kWaits && times_.row() == 1) row_.clear();
    row_.emplace_back(utime_us, now_us);
    if (verdict == Verdict::kBegins || verdict == Verdict::kGoesOn)
      for (const auto& [utime, arrived] : std::exchange(row_, {})) {
        EXPECT_EQ(times_.judge(utime, arrived, is_checked), Verdict::kNext);
        times_.take(utime, arrived);
      }
    return verdict;
  }
  // Returns the time that a camera on this clock would give the next image.
  int64_t right() const { return kNow_us + kPeriod_us * come_ - 20'000; }

  ImageTimes times_;
  int64_t come_ = 0;
  std::vector<std::pair<int64_t, int64_t>> row_;
};

TEST_F(ImageTimesTest, ACamerasImagesFollowEachOther) {
  for (int i = 0; i < 20; ++i) EXPECT_EQ(come(right()), Verdict::kNext);
}

TEST_F(ImageTimesTest, FarFromTheClockASessionBeginsWithTwoThatRise) {
  EXPECT_EQ(come(0), Verdict::kWaits);
  EXPECT_EQ(come(kPeriod_us), Verdict::kBegins);
  EXPECT_EQ(come(2 * kPeriod_us), Verdict::kNext);
}

TEST_F(ImageTimesTest, WhatCameraDriverPlaysNeedsNoClock) {
  EXPECT_EQ(come(0, true), Verdict::kNext);
  EXPECT_EQ(come(20'000'000, true), Verdict::kNext) << "a picture each 20 s, played many times as fast";
  EXPECT_EQ(come(40'000'000, true), Verdict::kNext);
}

TEST_F(ImageTimesTest, TimesThatStandBeginNothing) {
  for (const int64_t stands : {int64_t{0}, int64_t{4711}, 2 * kNow_us}) {
    times_ = {};
    for (int i = 0; i < 100; ++i) ASSERT_EQ(come(stands), Verdict::kWaits);
    EXPECT_EQ(times_.row(), 1);
    EXPECT_TRUE(times_.are_none());
    EXPECT_EQ(times_.what_is_wrong(), "the times of the images stand (" + std::to_string(stands) + ")");
  }
}

TEST_F(ImageTimesTest, OtherUnitsBeginNothingAndAreNamed) {
  for (int i = 0; i < 100; ++i) ASSERT_EQ(come(right() / 1'000'000), Verdict::kWaits);
  EXPECT_THAT(times_.what_is_wrong(), HasSubstr(", as seconds do"));
  for (int i = 0; i < 100; ++i) ASSERT_EQ(come(right() / 1000), Verdict::kWaits);
  EXPECT_THAT(times_.what_is_wrong(), ::testing::ContainsRegex("rise by 3[34] us in 33.3 ms, as milliseconds do"));
  for (int i = 0; i < 100; ++i) ASSERT_EQ(come((right() - kNow_us + kHour_us) * 1000), Verdict::kWaits);
  EXPECT_THAT(times_.what_is_wrong(), HasSubstr("rise by 33.3 s in 0.0333 s, as nanoseconds do"));
  EXPECT_EQ(come(right()), Verdict::kNext) << "as soon as they are right";
}

TEST_F(ImageTimesTest, TimesThatStandInTheMiddleBeginNoOtherSession) {
  for (int i = 0; i < 5; ++i) come(right());
  for (int i = 0; i < 50; ++i) ASSERT_EQ(come(0), Verdict::kWaits);
  EXPECT_TRUE(times_.are_none());
  EXPECT_EQ(come(right()), Verdict::kNext);
}

TEST_F(ImageTimesTest, OneInTwentyAnHourAheadIsLeftOut) {
  for (const int64_t ahead_us : {kHour_us, int64_t{5'000'000}, int64_t{1'500'000}})
    for (int i = 0; i < 60; ++i) {
      const bool is_wrong = i % 20 == 19;
      ASSERT_EQ(come(right() + (is_wrong ? ahead_us : 0)), is_wrong ? Verdict::kWaits : Verdict::kNext) << i;
      if (is_wrong) {
        EXPECT_EQ(times_.doubt(), Doubt::kAhead);
      }
    }
}

TEST_F(ImageTimesTest, TheFirstOneMayBeWrong) {
  EXPECT_EQ(come(right() + kHour_us), Verdict::kWaits);
  EXPECT_THAT(times_.what_is_wrong(), HasSubstr("is far from the clock's"));
  EXPECT_EQ(come(right()), Verdict::kNext);
}

TEST_F(ImageTimesTest, AClockThatIsSetForwardGoesOn) {
  for (int i = 0; i < 5; ++i) come(right());
  for (int i = 0; i < 4; ++i) EXPECT_EQ(come(right() + kHour_us), Verdict::kWaits);
  EXPECT_EQ(come(right() + kHour_us), Verdict::kGoesOn);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(come(right() + kHour_us), Verdict::kNext);
}

TEST_F(ImageTimesTest, AShortLeapLosesNothing) {
  for (int i = 0; i < 5; ++i) come(right());
  std::vector<Verdict> verdicts;
  for (int i = 0; i < 4; ++i) verdicts.push_back(come(right() + 1'500'000));
  EXPECT_THAT(verdicts, ElementsAre(Verdict::kWaits, Verdict::kWaits, Verdict::kGoesOn, Verdict::kNext));
}

TEST_F(ImageTimesTest, APauseOfTheCameraIsNoLeap) {
  for (int i = 0; i < 5; ++i) come(right());
  come_ += 3000;
  EXPECT_EQ(come(right()), Verdict::kNext);
}

TEST_F(ImageTimesTest, OldOnesAreRefusedAndTenInARowBeginASession) {
  for (int i = 0; i < 5; ++i) come(right());
  EXPECT_EQ(come(right() - 70'000), Verdict::kWaits);
  EXPECT_EQ(times_.doubt(), Doubt::kOlder);
  EXPECT_EQ(come(right()), Verdict::kNext);
  for (int i = 0; i < 9; ++i) EXPECT_EQ(come(right() - kHour_us), Verdict::kWaits);
  EXPECT_EQ(come(right() - kHour_us), Verdict::kBegins);
  EXPECT_EQ(come(right() - kHour_us), Verdict::kNext);
}

TEST_F(ImageTimesTest, OnesOfTheSameTimeAreDoubled) {
  for (int i = 0; i < 20; ++i) {
    const int64_t time_us = right();
    EXPECT_EQ(come(time_us), Verdict::kNext);
    EXPECT_EQ(come(time_us), Verdict::kDoubled);
  }
}

}  // namespace
}  // namespace rumi::front_tracker
