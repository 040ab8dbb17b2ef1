// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/merging/map_merger.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <ctime>

#include "tests/map_server/merging/map_merger_fixture.h"
#include "tests/map_server/place_map.h"

namespace rumi::testing {
namespace {

using Scope = BuildScope;

double process_cpu_s() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

TEST_F(MapMergerTest, NothingToDoAtFirst) {
  MapMerger merger(options_);
  EXPECT_TRUE(merger.idle(atlas_));
  merger.hurry();
  EXPECT_FALSE(tick(&merger, 0));
  EXPECT_TRUE(merger.idle(atlas_));
  EXPECT_FALSE(merger.running());
}

TEST_F(MapMergerTest, LooksAtWhatIsNewNowAndThen) {
  MapMerger merger(options_);
  put(Chain::kFront1);
  EXPECT_FALSE(merger.idle(atlas_));
  const auto first = tick(&merger, 10);
  ASSERT_TRUE(first);
  EXPECT_TRUE(first->map.placements().empty()) << "one submap is a map as it is, until it is adjusted";
  EXPECT_FALSE(merger.idle(atlas_));
  for (double now_s = 10; now_s < 30; ++now_s) EXPECT_FALSE(tick(&merger, now_s));
  const auto adjusted = tick(&merger, 30);
  ASSERT_TRUE(adjusted);
  EXPECT_EQ(adjusted->scope, Scope::kOnTheWay);
  EXPECT_EQ(adjusted->map.placements().size(), 1u);
  EXPECT_FALSE(merger.idle(atlas_)) << "what its points are seen by besides is still to be found";
  for (double now_s = 30; now_s < 110; ++now_s) EXPECT_FALSE(tick(&merger, now_s));
  const auto all = tick(&merger, 110);
  ASSERT_TRUE(all);
  EXPECT_EQ(all->scope, Scope::kAll);
  EXPECT_TRUE(merger.idle(atlas_));
  for (double now_s = 110; now_s < 200; ++now_s) EXPECT_FALSE(tick(&merger, now_s));

  put(Chain::kFront2);
  EXPECT_TRUE(tick(&merger, 200));
  const auto second = tick(&merger, 201);
  ASSERT_TRUE(second) << "the adjustment was due long ago";
  EXPECT_EQ(second->map.placements().size(), 1u) << "they have nothing in common";
  change(Chain::kFront2);
  EXPECT_FALSE(tick(&merger, 202.9));
  EXPECT_TRUE(tick(&merger, 203));
  change(Chain::kFront2);
  EXPECT_TRUE(tick(&merger, 1)) << "the clock was set back";
}

TEST_F(MapMergerTest, ABackSubmapTiesTwoFrontsAndTheWholeIsAdjustedLater) {
  MapMerger merger(options_);
  put(Chain::kFront1);
  put(Chain::kFront2);
  ASSERT_TRUE(tick(&merger, 0));
  put(Chain::kBack1);
  const auto weld = tick(&merger, 4);
  ASSERT_TRUE(weld);
  EXPECT_EQ(weld->scope, Scope::kWeld);
  EXPECT_EQ(weld->map.placements().size(), 3u);
  EXPECT_EQ(weld->report.members, 3);
  EXPECT_GT(weld->cpu_s, 0);
  EXPECT_EQ(std::count_if(weld->links.begin(), weld->links.end(), [](const Link& link) { return link.accepted(); }), 2);
  EXPECT_LT(chain_->error(atlas_).rmse, 0.05);

  EXPECT_FALSE(merger.idle(atlas_)) << "the whole map is still to be adjusted";
  for (double now_s = 4; now_s < options_.adjustment_interval_s; now_s += 0.5) EXPECT_FALSE(tick(&merger, now_s));
  const auto all = tick(&merger, options_.adjustment_interval_s);
  ASSERT_TRUE(all);
  EXPECT_EQ(all->scope, Scope::kOnTheWay);
  EXPECT_EQ(all->map.placements().size(), 3u);
  EXPECT_LT(chain_->error(atlas_).rmse, 0.04);
  EXPECT_EQ(all->report.observed, 0);
  for (double now_s = 20; now_s < 100; ++now_s) EXPECT_FALSE(tick(&merger, now_s));
  const auto settled = tick(&merger, 100);
  ASSERT_TRUE(settled);
  EXPECT_EQ(settled->scope, Scope::kAll);
  EXPECT_GT(settled->report.observed, 0);
  EXPECT_LT(chain_->error(atlas_).rmse, 0.04);
  EXPECT_TRUE(merger.idle(atlas_));
  for (double now_s = 100; now_s < 1000; ++now_s) EXPECT_FALSE(tick(&merger, now_s));
}

TEST_F(MapMergerTest, ALargerMapIsAdjustedLessOften) {
  options_.adjustment_interval_s = 0;
  MapMerger merger(options_);
  for (const SubmapKey key : {Chain::kFront1, Chain::kBack1, Chain::kFront2}) put(key);
  const auto weld = tick(&merger, 0);
  ASSERT_TRUE(weld);
  ASSERT_GT(weld->report.views, 10);
  EXPECT_FALSE(tick(&merger, 0.25 * weld->report.views - 0.1));
  EXPECT_TRUE(tick(&merger, 0.25 * weld->report.views));
}

// In a known room front_tracker still corrects its submaps all the time.
TEST_F(MapMergerTest, AMapThatIsMuchAsItWasIsAdjustedLessOften) {
  options_.adjustment_interval_s = 100;
  MapMerger merger(options_);
  const Growth growth = begin_to_grow(&merger);
  change(Chain::kFront1);
  const auto weld = tick(&merger, 10);
  ASSERT_TRUE(weld);
  EXPECT_EQ(weld->scope, Scope::kWeld);
  EXPECT_FALSE(tick(&merger, 399));
  const auto corrected = tick(&merger, 400);
  ASSERT_TRUE(corrected);
  EXPECT_EQ(corrected->scope, Scope::kAll);

  testing::put(growth.late, &atlas_);
  ASSERT_TRUE(tick(&merger, 410));
  EXPECT_FALSE(tick(&merger, 499));
  const auto grown = tick(&merger, 500);
  ASSERT_TRUE(grown) << "it has grown";
  EXPECT_EQ(grown->scope, Scope::kOnTheWay);
}

TEST_F(MapMergerTest, InAHurryAllIsDoneAtOnce) {
  MapMerger merger(options_);
  put(Chain::kFront1);
  put(Chain::kFront2);
  ASSERT_TRUE(tick(&merger, 0));
  put(Chain::kBack1);
  merger.hurry();
  const auto all = tick(&merger, 0.1);
  ASSERT_TRUE(all);
  EXPECT_EQ(all->scope, Scope::kAll);
  EXPECT_EQ(all->map.placements().size(), 3u);
  EXPECT_TRUE(merger.idle(atlas_));
  // After a weld, a hurry causes the adjustment that is still to be done.
  put(Chain::kBack2);
  put(Chain::kFront3);
  const auto weld = tick(&merger, 3);
  ASSERT_TRUE(weld);
  EXPECT_EQ(weld->scope, Scope::kWeld);
  EXPECT_FALSE(tick(&merger, 3));
  merger.hurry();
  const auto rest = tick(&merger, 3);
  ASSERT_TRUE(rest);
  EXPECT_EQ(rest->scope, Scope::kAll);
  EXPECT_EQ(rest->map.placements().size(), 5u);
  EXPECT_LT(chain_->error(atlas_).rmse, 0.04);
  // The hurry is over: what comes next is not built at once.
  change(Chain::kFront3);
  EXPECT_FALSE(tick(&merger, 3.1));
}

TEST_F(MapMergerTest, AChangeIsNews) {
  MapMerger merger(options_);
  const Growth growth = begin_to_grow(&merger);
  ASSERT_TRUE(merger.idle(atlas_));
  const size_t early = atlas_.find(Chain::kFront2)->placement.map_from_submap.size();
  testing::put(growth.late, &atlas_);
  EXPECT_FALSE(merger.idle(atlas_));
  EXPECT_FALSE(tick(&merger, 1));
  EXPECT_TRUE(tick(&merger, 2));
  EXPECT_FALSE(merger.idle(atlas_));
  const auto all = tick(&merger, options_.adjustment_interval_s);
  ASSERT_TRUE(all);
  EXPECT_EQ(all->scope, Scope::kOnTheWay);
  EXPECT_EQ(early, 7u);
  EXPECT_EQ(atlas_.find(Chain::kFront2)->placement.map_from_submap.size(), growth.late.keyframes.size());
  EXPECT_LT(chain_->error(atlas_).rmse, 0.04);
}

TEST_F(MapMergerTest, DoesNothingWhereItIsNotWanted) {
  options_.enabled = false;
  MapMerger merger(options_);
  for (const SubmapKey key : {Chain::kFront1, Chain::kBack1, Chain::kFront2}) put(key);
  merger.hurry();
  for (double now_s = 0; now_s < 100; ++now_s) EXPECT_FALSE(tick(&merger, now_s));
  EXPECT_TRUE(merger.idle(atlas_));
}

TEST_F(MapMergerTest, AThreadMakesTheSameMap) {
  for (const SubmapKey key : {Chain::kFront1, Chain::kBack1, Chain::kFront2}) put(key);
  const Atlas before = atlas_;
  MapMerger at_once(options_);
  const auto weld = tick(&at_once, 0);
  at_once.hurry();
  const auto all = tick(&at_once, 0);
  ASSERT_TRUE(weld && all);

  atlas_ = before;
  options_.thread = true;
  MapMerger merger(options_);
  EXPECT_FALSE(tick(&merger, 0));
  EXPECT_TRUE(merger.running());
  EXPECT_FALSE(merger.idle(atlas_));
  change(Chain::kBack1);  // has no effect on the running build, because the thread works on copies
  const auto same_weld = wait(&merger, 0);
  ASSERT_TRUE(same_weld);
  atlas_ = before;
  testing::place_map(&atlas_, same_weld->map.placements());
  merger.hurry();
  EXPECT_FALSE(tick(&merger, 0));
  const auto same_all = wait(&merger, 0);
  ASSERT_TRUE(same_all);
  EXPECT_EQ(same_all->scope, Scope::kAll);
  EXPECT_TRUE(merger.idle(atlas_));
  for (const auto& [expected, got] : {std::pair{&weld, &same_weld}, std::pair{&all, &same_all}}) {
    EXPECT_EQ((*expected)->links, (*got)->links);
    ASSERT_EQ((*expected)->map.placements().size(), (*got)->map.placements().size());
    for (const auto& [key, placement] : (*expected)->map.placements())
      EXPECT_TRUE(same_place(placement, (*got)->map.placements().at(key)));
  }
}

// Submaps that came while the whole map was adjusted are not in the adjusted map.
TEST_F(MapMergerTest, AHurryDuringAnAdjustmentIsNotForgotten) {
  options_.thread = true;
  MapMerger merger(options_);
  for (const SubmapKey key : {Chain::kFront1, Chain::kBack1, Chain::kFront2}) put(key);
  merger.hurry();
  EXPECT_FALSE(tick(&merger, 0));
  put(Chain::kBack2);
  put(Chain::kFront3);
  merger.hurry();
  const auto first = wait(&merger, 0);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->scope, Scope::kAll);
  EXPECT_EQ(first->map.placements().size(), 3u);
  EXPECT_FALSE(tick(&merger, 0));
  ASSERT_TRUE(merger.running());
  const auto second = wait(&merger, 0);
  ASSERT_TRUE(second);
  EXPECT_EQ(second->scope, Scope::kAll);
  EXPECT_EQ(second->map.placements().size(), 5u);
  EXPECT_TRUE(merger.idle(atlas_));
}

TEST_F(MapMergerTest, ABuildInAHurryEndsInTimeAndItsMapCounts) {
  for (const SubmapKey key : {Chain::kFront1, Chain::kBack1, Chain::kFront2, Chain::kBack2, Chain::kFront3}) put(key);
  options_.thread = true;
  options_.final_s = 0;
  MapMerger merger(options_);
  merger.hurry();
  EXPECT_FALSE(tick(&merger, 0));
  const auto in_time = wait(&merger, 1);
  ASSERT_TRUE(in_time);
  EXPECT_EQ(in_time->scope, Scope::kAll);
  EXPECT_EQ(in_time->map.placements().size(), 5U) << "nothing is left out";
  EXPECT_TRUE(merger.idle(atlas_));
}

TEST_F(MapMergerTest, GivesUpWhatIsUnderWayAtTheEnd) {
  for (const SubmapKey key : {Chain::kFront1, Chain::kBack1, Chain::kFront2, Chain::kBack2, Chain::kFront3}) put(key);
  MapMerger at_once(options_);
  at_once.hurry();
  const auto whole = tick(&at_once, 0);
  ASSERT_TRUE(whole);
  options_.thread = true;
  const double start_s = process_cpu_s();
  {
    MapMerger merger(options_);
    merger.hurry();
    merger.tick(0, atlas_);
    EXPECT_TRUE(merger.running());
  }
  const double spent_s = process_cpu_s() - start_s;
  std::printf("the whole: %.2f s of CPU, given up after %.2f s\n", whole->cpu_s, spent_s);
  EXPECT_LT(spent_s, whole->cpu_s / 3);
}

}  // namespace
}  // namespace rumi::testing
