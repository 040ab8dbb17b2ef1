// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/merging/suspects.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace rumi::map_server {
namespace {

using Scope = BuildScope;
using Keys = std::set<SubmapKey>;

SubmapKey key(int id) { return {1, id}; }

class SuspectsTest : public ::testing::Test {
 protected:
  // Begins with `n` submaps at their first revision.
  explicit SuspectsTest(int n = 16) {
    for (int id = 1; id <= n; ++id) all_[key(id)] = 1;
  }
  // Simulates a build. It throws if it has any of bad_ at the same revision, or all of together_. Returns true if it
  // does not.
  bool build(Scope scope = Scope::kWeld) {
    ++builds_;
    chosen_ = suspects_.choose(all_, suspects_.unfinished().value_or(scope), now_us_);
    const bool breaks = std::any_of(bad_.begin(), bad_.end(), [&](const auto& item) {
      const auto at = chosen_.find(item.first);
      return at != chosen_.end() && at->second == item.second;
    });
    const bool clash = !together_.empty() && std::all_of(together_.begin(), together_.end(),
                                                         [&](SubmapKey k) { return chosen_.contains(k); });
    if (breaks || clash)
      suspects_.broke_off({}, now_us_);
    else
      suspects_.built();
    return !breaks && !clash;
  }
  // Builds until all submaps in doubt have been tried.
  void build_until_it_is_known(Scope scope = Scope::kWeld) {
    build(scope);
    while (suspects_.unfinished() && builds_ < 1000) build(scope);
  }
  size_t all_but(size_t n) const { return all_.size() - n; }

  Suspects suspects_;
  Suspects::Revisions all_, bad_, chosen_;
  Keys together_;
  int64_t now_us_ = 5'000'000;
  int builds_ = 0;
};

TEST_F(SuspectsTest, AllAreChosenWhileNothingBreaksOff) {
  EXPECT_TRUE(build());
  EXPECT_EQ(chosen_, all_);
  EXPECT_FALSE(suspects_.unfinished());
  EXPECT_TRUE(suspects_.left_out().empty());
  EXPECT_TRUE(suspects_.is_done(key(1), 1, now_us_));
  EXPECT_FALSE(suspects_.is_done(key(1), 2, now_us_));
}

TEST_F(SuspectsTest, WhatAloneIsNewIsLeftOutAtOnce) {
  build();
  bad_[key(7)] = all_[key(7)] = 2;
  EXPECT_FALSE(build());
  EXPECT_FALSE(suspects_.unfinished());
  EXPECT_EQ(suspects_.left_out(), Keys{key(7)});
  EXPECT_TRUE(suspects_.is_done(key(7), 2, now_us_));
  EXPECT_TRUE(build());
  EXPECT_EQ(chosen_.size(), all_but(1));
}

// All submaps are new, as at a start from a database.
TEST_F(SuspectsTest, WhereAllAreNewTheOneToBlameIsFoundByHalves) {
  bad_[key(11)] = 1;
  build_until_it_is_known();
  EXPECT_EQ(suspects_.left_out(), Keys{key(11)});
  EXPECT_LE(builds_, 9) << "one, and two for each halving";
  EXPECT_TRUE(build());
  EXPECT_EQ(chosen_.size(), all_but(1));
}

TEST_F(SuspectsTest, WhereSomeAreToBlameTheOthersAreNotTriedByHalves) {
  suspects_.choose(all_, Scope::kWeld, now_us_);
  EXPECT_EQ(suspects_.fresh().size(), all_.size());
  EXPECT_TRUE(suspects_.broke_off({key(3), key(5)}, now_us_));
  EXPECT_FALSE(suspects_.unfinished());
  EXPECT_EQ(suspects_.left_out(), (Keys{key(3), key(5)}));
  EXPECT_FALSE(suspects_.is_done(key(4), 1, now_us_));
  EXPECT_TRUE(build());
  EXPECT_EQ(chosen_.size(), all_but(2));
}

TEST_F(SuspectsTest, SeveralAreFoundToo) {
  bad_ = {{key(1), 1}, {key(2), 1}, {key(9), 1}, {key(16), 1}};
  build_until_it_is_known();
  EXPECT_EQ(suspects_.left_out(), (Keys{key(1), key(2), key(9), key(16)}));
  EXPECT_LE(builds_, 2 * 16);
  EXPECT_TRUE(build());
}

TEST_F(SuspectsTest, OfTwoThatDoNotGoTogetherOneIsLeftOut) {
  together_ = {key(3), key(12)};
  build_until_it_is_known();
  EXPECT_EQ(suspects_.left_out().size(), 1u);
  EXPECT_TRUE(build());
  EXPECT_EQ(chosen_.size(), all_but(1));
}

TEST_F(SuspectsTest, ThatAllBreakOffTakesTwoBuildsEachAndNoMore) {
  for (const auto& [k, revision] : all_) bad_[k] = revision;
  build_until_it_is_known();
  EXPECT_EQ(suspects_.left_out().size(), all_.size());
  EXPECT_EQ(builds_, 2 * 16 - 1);
}

TEST_F(SuspectsTest, WhatHasChangedIsTriedAgainAfterAMinute) {
  build();
  bad_[key(7)] = all_[key(7)] = 2;
  build();
  all_[key(7)] = 3;
  EXPECT_TRUE(suspects_.is_done(key(7), 3, now_us_ + 1'000'000));
  EXPECT_TRUE(suspects_.is_done(key(7), 2, now_us_ + 61'000'000)) << "it is as it was";
  EXPECT_FALSE(suspects_.is_done(key(7), 3, now_us_ + 61'000'000));
  now_us_ += 61'000'000;
  EXPECT_TRUE(build());
  EXPECT_EQ(chosen_, all_);
  EXPECT_TRUE(suspects_.left_out().empty());
}

TEST_F(SuspectsTest, WhatCanBeWeldedMayBreakOffTheAdjustment) {
  EXPECT_TRUE(build(Scope::kWeld));
  bad_[key(4)] = 1;
  build_until_it_is_known(Scope::kAll);
  EXPECT_EQ(suspects_.left_out(), Keys{key(4)});
  EXPECT_TRUE(build(Scope::kAll));
  EXPECT_TRUE(build(Scope::kWeld)) << "nor does it know it any more";
  EXPECT_EQ(chosen_.size(), all_but(1));
}

TEST_F(SuspectsTest, WhereNothingIsNewNobodyIsToBlame) {
  EXPECT_TRUE(build(Scope::kAll));
  suspects_.choose(all_, Scope::kAll, now_us_);
  EXPECT_FALSE(suspects_.broke_off({}, now_us_));
  EXPECT_TRUE(suspects_.left_out().empty());
  EXPECT_FALSE(suspects_.unfinished());
  EXPECT_TRUE(build(Scope::kWeld));
  EXPECT_EQ(chosen_, all_);
}

TEST_F(SuspectsTest, WhatABuildMadeOfASubmapIsNoNews) {
  build(Scope::kAll);
  suspects_.replaced(key(5), 2);
  EXPECT_TRUE(suspects_.is_done(key(5), 2, now_us_));
}

}  // namespace
}  // namespace rumi::map_server
