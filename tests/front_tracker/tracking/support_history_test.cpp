// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/tracking/support_history.h"

#include <gtest/gtest.h>

#include <map>

namespace rumi::front_tracker {
namespace {

Frame tracked(int64_t utime_us, int inliers, double log_scale_variance = 0) {
  Frame frame;
  frame.utime_us = utime_us;
  frame.landmark_ids.assign(inliers, 1);
  frame.certainty.log_scale_variance = log_scale_variance;
  return frame;
}

TEST(SupportHistory, TheScaleDriftsByWhatCameToItWithinASecond) {
  constexpr double kMost = 0.1;
  SupportHistory history;
  EXPECT_FALSE(history.scale_drifts(tracked(0, 50, 1), kMost)) << "nothing to compare with";
  history.add(tracked(0, 50, 0.001));
  history.add(tracked(600'000, 50, 0.008));
  EXPECT_FALSE(history.scale_drifts(tracked(900'000, 50, 0.0105), kMost));
  EXPECT_TRUE(history.scale_drifts(tracked(900'000, 50, 0.0115), kMost));
  EXPECT_FALSE(history.scale_drifts(tracked(1'100'000, 50, 0.0115), kMost)) << "slower";
  EXPECT_TRUE(history.scale_drifts(tracked(9'000'000, 50, 0.0185), kMost)) << "since the last frame there was";
}

TEST(SupportHistory, ItIsWeakFromTheWeakestFrameOnOrFromOneBeforeItThatIsHardlyStronger) {
  SupportHistory history;
  EXPECT_EQ(history.begin_us(), std::nullopt);
  for (const auto& [utime_us, inliers] : std::map<int64_t, int>{{1, 100}, {2, 35}, {3, 20}, {4, 90}})
    history.add(tracked(utime_us, inliers));
  EXPECT_EQ(history.begin_us(), 1);
  EXPECT_EQ(history.weak_since_us(), 2);
  history.forget_from(2);
  EXPECT_EQ(history.weak_since_us(), 1);
  history.forget_from(0);
  EXPECT_EQ(history.begin_us(), std::nullopt);
}

TEST(SupportHistory, FourSecondsAreKept) {
  SupportHistory history;
  for (const int64_t utime_us : {0, 1'000'000, 4'500'000}) history.add(tracked(utime_us, 50));
  EXPECT_EQ(history.begin_us(), 1'000'000);
}

}  // namespace
}  // namespace rumi::front_tracker
