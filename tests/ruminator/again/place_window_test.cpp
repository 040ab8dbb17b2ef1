// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/again/place_window.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace rumi::ruminator {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::Le;
using ::testing::SizeIs;

// Images 0, 1, 2, ... of a walk; image i looks like those near `place[i]`.
struct Walk {
  std::vector<PlaceCandidate> candidates;
  std::vector<double> place;
  void add(int count, int island, double from_place) {
    for (int i = 0; i < count; ++i) {
      candidates.push_back({{.utime_us = static_cast<int64_t>(candidates.size())}, island});
      place.push_back(from_place + i);
    }
  }
  std::vector<size_t> choose(const std::vector<Island>& islands, int most, std::vector<int>* taken) const {
    const auto similarity = [this](size_t a, size_t b) { return std::exp(-std::abs(place[a] - place[b])); };
    return choose_place_window(candidates, islands, similarity, most, taken);
  }
  int of_island(const std::vector<size_t>& chosen, int island) const {
    return static_cast<int>(
        std::count_if(chosen.begin(), chosen.end(), [&](size_t i) { return candidates[i].island == island; }));
  }
};

TEST(PlaceWindow, TakesTheMapsImagesThatLookLikeTheIsland) {
  Walk walk;
  walk.add(100, PlaceCandidate::kInMap, 0);
  walk.add(10, 0, 20);  // sees again what images 20 to 29 saw
  std::vector<int> taken;
  const std::vector<size_t> chosen = walk.choose({{0, 10}}, 30, &taken);
  EXPECT_THAT(taken, ElementsAre(0));
  EXPECT_TRUE(std::is_sorted(chosen.begin(), chosen.end()));
  EXPECT_EQ(walk.of_island(chosen, 0), 10);
  for (size_t i = 20; i < 30; ++i) EXPECT_THAT(chosen, Contains(i));
  EXPECT_THAT(chosen, Contains(99u)) << "the neighbour in time";
  EXPECT_LE(chosen.size(), 30u);
}

TEST(PlaceWindow, ThinsIslandsBeforeItLeavesOneOut) {
  Walk walk;
  walk.add(50, PlaceCandidate::kInMap, 0);
  walk.add(60, 0, 0);
  walk.add(60, 1, 20);
  std::vector<int> taken;
  const std::vector<size_t> chosen = walk.choose({{1, 60}, {0, 70}}, 60, &taken);
  EXPECT_THAT(taken, ElementsAre(0, 1)) << "the larger one first";
  EXPECT_GE(walk.of_island(chosen, 0), 15);
  EXPECT_GE(walk.of_island(chosen, 1), 15);
  EXPECT_THAT(chosen, SizeIs(Le(60)));
}

TEST(PlaceWindow, TheSmallestIslandsWait) {
  Walk walk;
  std::vector<Island> islands;
  for (int k = 0; k < 20; ++k) {
    walk.add(6, k, 10 * k);
    islands.push_back({k, 6 + k});
  }
  std::vector<int> taken;
  walk.choose(islands, 60, &taken);
  ASSERT_FALSE(taken.empty());
  EXPECT_LT(taken.size(), 20u);
  EXPECT_EQ(taken.front(), 19);
}

TEST(PlaceWindow, OfNoIslandsIsEmpty) {
  Walk walk;
  walk.add(10, PlaceCandidate::kInMap, 0);
  std::vector<int> taken;
  EXPECT_TRUE(walk.choose({}, 60, &taken).empty());
  EXPECT_TRUE(taken.empty());
}

}  // namespace
}  // namespace rumi::ruminator
