// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/merging/build_schedule.h"

#include <gtest/gtest.h>

namespace rumi::map_server {
namespace {

constexpr int64_t kSecond_us = 1'000'000;
constexpr BuildNeeds kNothing{.untried = {}, .has_news = false, .size = {3, 100}};
constexpr BuildNeeds kNews{.untried = {}, .has_news = true, .size = {3, 100}};
constexpr BuildNeeds kGrown{.untried = {}, .has_news = true, .size = {4, 130}};

// The schedule allows a build every 2 s and an adjustment every 20 s.
class BuildScheduleTest : public testing::Test {
 protected:
  std::optional<BuildScope> due(const BuildNeeds& needs, double now_s) const {
    return schedule_.due(needs, static_cast<int64_t>(now_s * kSecond_us));
  }
  void build(BuildScope scope, double now_s, int views = 10) {
    schedule_.begun(scope, static_cast<int64_t>(now_s * kSecond_us));
    schedule_.built(scope, 3, views, kNews.size);
  }
  BuildSchedule schedule_{2, 20};
};

TEST_F(BuildScheduleTest, NothingIsDueWhereNothingIsNew) {
  EXPECT_EQ(due(kNothing, 100), std::nullopt);
  EXPECT_TRUE(schedule_.is_at_rest(kNothing));
  schedule_.hurry();
  EXPECT_EQ(due(kNothing, 100), std::nullopt);
  schedule_.rest(kNothing);
  EXPECT_FALSE(schedule_.is_in_a_hurry()) << "nothing was left to do";
}

TEST_F(BuildScheduleTest, WeldsWhatIsNewOnceAnInterval) {
  EXPECT_EQ(due(kNews, 1), BuildScope::kWeld);
  build(BuildScope::kWeld, 1);
  EXPECT_EQ(due(kNews, 2.9), std::nullopt);
  EXPECT_EQ(due(kNews, 3), BuildScope::kWeld);
}

TEST_F(BuildScheduleTest, AdjustsOnTheWayWhileTheMapGrowsAndAllOnceItIsSettled) {
  build(BuildScope::kWeld, 0);
  EXPECT_FALSE(schedule_.is_at_rest(kNothing)) << "the map changed since it was adjusted";
  EXPECT_EQ(due(kNothing, 19.9), std::nullopt);
  EXPECT_EQ(due(kNothing, 20), BuildScope::kOnTheWay);
  build(BuildScope::kOnTheWay, 20);
  EXPECT_EQ(due(kGrown, 40), BuildScope::kOnTheWay) << "it grew";
  EXPECT_EQ(due(kNothing, 99.9), std::nullopt) << "four periods, where little changed";
  EXPECT_EQ(due(kNothing, 100), BuildScope::kAll);
  build(BuildScope::kAll, 100);
  EXPECT_EQ(due(kNothing, 1000), std::nullopt);
  EXPECT_TRUE(schedule_.is_at_rest(kNothing));
}

TEST_F(BuildScheduleTest, ALargeMapIsAdjustedLessOften) {
  build(BuildScope::kWeld, 0, 400);
  EXPECT_EQ(due(kNothing, 99.9), std::nullopt);
  EXPECT_EQ(due(kNothing, 100), BuildScope::kOnTheWay);
}

TEST_F(BuildScheduleTest, InAHurryAllIsDueAtOnceUntilItHasBegun) {
  build(BuildScope::kWeld, 0);
  schedule_.hurry();
  EXPECT_EQ(due(kNews, 0.1), BuildScope::kAll);
  schedule_.begun(BuildScope::kAll, kSecond_us);
  EXPECT_FALSE(schedule_.is_in_a_hurry());
  schedule_.hurry();  // because of submaps that came meanwhile
  schedule_.built(BuildScope::kAll, 3, 10, kNews.size);
  EXPECT_TRUE(schedule_.is_in_a_hurry());
  EXPECT_EQ(due(kNothing, 2), std::nullopt);
  EXPECT_EQ(due(kNews, 2), BuildScope::kAll);
}

TEST_F(BuildScheduleTest, AHurryOutlivesABuildThatBreaksOff) {
  schedule_.hurry();
  schedule_.begun(BuildScope::kAll, 0);
  schedule_.broke_off(true);
  EXPECT_TRUE(schedule_.is_in_a_hurry());
}

TEST_F(BuildScheduleTest, WhatBrokeOffWithNothingNewIsNotTriedForEver) {
  build(BuildScope::kWeld, 0);
  schedule_.begun(BuildScope::kOnTheWay, 20 * kSecond_us);
  schedule_.broke_off(false);
  EXPECT_EQ(due(kNothing, 1000), std::nullopt);
}

TEST_F(BuildScheduleTest, WhatIsInDoubtComesFirst) {
  build(BuildScope::kWeld, 0);
  BuildNeeds needs = kNews;
  needs.untried = BuildScope::kOnTheWay;
  EXPECT_EQ(due(needs, 1), std::nullopt);
  EXPECT_EQ(due(needs, 2), BuildScope::kOnTheWay);
  schedule_.hurry();
  EXPECT_EQ(due(needs, 1), BuildScope::kOnTheWay);
  EXPECT_FALSE(schedule_.is_at_rest(needs));
}

TEST_F(BuildScheduleTest, AClockThatWasSetBackDelaysNothing) {
  build(BuildScope::kWeld, 1000);
  EXPECT_NE(due(kNews, 10), std::nullopt);
}

}  // namespace
}  // namespace rumi::map_server
