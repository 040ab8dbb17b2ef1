// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/again/place_window.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace rumi::ruminator {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;

// Images 0, 1, 2, ... of a walk; image i looks like those near `place[i]`.
struct Walk {
  std::vector<WindowCandidate> candidates;
  std::vector<double> place;
  void add(int count, int island, double from_place) {
    for (int i = 0; i < count; ++i) {
      candidates.push_back({{.utime_us = static_cast<int64_t>(candidates.size())}, island});
      place.push_back(from_place + i);
    }
  }
  PlaceWindow choose(int seed, int most) const {
    const auto similarity = [this](size_t a, size_t b) { return std::exp(-std::abs(place[a] - place[b])); };
    return choose_place_window(candidates, seed, similarity, most);
  }
};

std::vector<int64_t> utimes_of(const PlaceWindow& window) {
  std::vector<int64_t> utimes;
  for (const WindowCandidate& candidate : window.candidates) utimes.push_back(candidate.sample.utime_us);
  return utimes;
}

int images_of(const PlaceWindow& window, int island) {
  return static_cast<int>(std::count_if(window.candidates.begin(), window.candidates.end(),
                                        [&](const WindowCandidate& c) { return c.island == island; }));
}

TEST(PlaceWindow, TakesTheMapsImagesThatLookLikeTheIsland) {
  Walk walk;
  walk.add(100, WindowCandidate::kInMap, 0);
  walk.add(10, 0, 20);  // sees again what images 20 to 29 saw
  const PlaceWindow window = walk.choose(0, 30);
  EXPECT_THAT(window.islands, ElementsAre(0));
  const std::vector<int64_t> utimes = utimes_of(window);
  EXPECT_TRUE(std::is_sorted(utimes.begin(), utimes.end()));
  EXPECT_EQ(images_of(window, 0), 10);
  for (int64_t i = 20; i < 30; ++i) EXPECT_THAT(utimes, Contains(i));
  EXPECT_THAT(utimes, Contains(99)) << "the neighbour in time";
  EXPECT_LE(utimes.size(), 30u);
}

TEST(PlaceWindow, GrowsToTheIslandThatLooksAlike) {
  Walk walk;
  walk.add(20, 0, 0);
  walk.add(20, 1, 500);
  walk.add(20, 2, 10);  // sees again what island 0 sees, and goes on
  const PlaceWindow window = walk.choose(0, 50);
  EXPECT_THAT(window.islands, ElementsAre(0, 2));
  EXPECT_EQ(images_of(window, 0), 20);
  EXPECT_EQ(images_of(window, 2), 15) << "no more than its share of the window";
}

TEST(PlaceWindow, TakesNeighboursOfALongIsland) {
  Walk walk;
  walk.add(200, 0, 0);
  const std::vector<int64_t> utimes = utimes_of(walk.choose(0, 40));
  ASSERT_EQ(utimes.size(), 28u);
  EXPECT_EQ(utimes.back() - utimes.front(), 27) << "not thinned: images must overlap";
}

TEST(PlaceWindow, IsEmptyWithoutTheIsland) {
  Walk walk;
  walk.add(10, WindowCandidate::kInMap, 0);
  EXPECT_TRUE(walk.choose(0, 60).candidates.empty());
  EXPECT_TRUE(walk.choose(WindowCandidate::kInMap, 60).candidates.empty());
}

}  // namespace
}  // namespace rumi::ruminator
