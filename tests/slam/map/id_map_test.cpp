// SPDX-License-Identifier: BSD-3-Clause
#include "slam/map/id_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <string>

namespace rumi {
namespace {

using Pairs = std::vector<std::pair<int, int>>;

template <typename Map>
Pairs forward(const Map& map) {
  Pairs all;
  for (const auto& [id, value] : map) all.emplace_back(id, value);
  return all;
}

template <typename Map>
Pairs backward(const Map& map) {
  Pairs all;
  for (auto at = map.rbegin(); at != map.rend(); ++at) all.emplace_back(at->first, at->second);
  return all;
}

void expect_same(const IdMap<int>& map, const std::map<int, int>& like, int most) {
  ASSERT_EQ(forward(map), forward(like));
  ASSERT_EQ(backward(map), backward(like));
  ASSERT_EQ(map.size(), like.size());
  ASSERT_EQ(map.empty(), like.empty());
  for (int id = -2; id < most; ++id) {
    ASSERT_EQ(map.contains(id), like.contains(id)) << id;
    ASSERT_EQ(map.find(id) == map.end(), !like.contains(id)) << id;
    const auto at = map.lower_bound(id);
    const auto expected = like.lower_bound(id);
    ASSERT_EQ(at == map.end(), expected == like.end()) << id;
    if (expected != like.end()) {
      ASSERT_EQ(at->first, expected->first) << id;
    }
  }
}

TEST(IdMap, CopiesShareWhatNeitherHasChanged) {
  IdMap<int> map;
  for (int id = 0; id < 200; ++id) map.emplace(id, id);
  IdMap<int> copy = map;
  const IdMap<int>&read = map, &read_copy = copy;
  for (int id = 0; id < 200; ++id) EXPECT_EQ(read.get(id), read_copy.get(id)) << "one value for both";
  copy.at(70) = -1;
  EXPECT_EQ(read.at(70), 70);
  EXPECT_NE(read.get(100), read_copy.get(100)) << "of the same leaf";
  EXPECT_EQ(read.get(10), read_copy.get(10));
  map.erase(10);
  EXPECT_EQ(read_copy.at(10), 10);
  copy = {};
  EXPECT_EQ(read.at(199), 199);
}

TEST(IdMap, IsUsedAsAMapOfTheStandard) {
  constexpr int kMost = 400;
  std::mt19937 rng(1);
  IdMap<int> map;
  std::map<int, int> like;
  expect_same(map, like, kMost);
  for (int i = 0; i < 2000; ++i) {
    const int id = static_cast<int>(rng() % kMost);
    switch (rng() % 5) {
      case 0:
      case 1:
        map[id] = like[id] = i;
        break;
      case 2:
        ASSERT_EQ(map.emplace(id, i).second, like.emplace(id, i).second);
        break;
      default:  // long enough to empty whole leaves
        for (int k = id; k < id + 40; ++k) ASSERT_EQ(map.erase(k), like.erase(k));
    }
    if (i % 50 == 0) expect_same(map, like, kMost);
  }
  expect_same(map, like, kMost);
  const IdMap<int> copy = map;
  map.clear();
  expect_same(map, {}, kMost);
  expect_same(copy, like, kMost);
  map = copy;
  expect_same(map, like, kMost);
  IdMap<int> moved = std::move(map);
  expect_same(moved, like, kMost);
  for (auto at = moved.begin(); at != moved.end();) at = moved.erase(at);
  expect_same(moved, {}, kMost);
}

TEST(IdMap, ValuesStayWhereTheyAre) {
  IdMap<std::string> map;
  const std::string* first = &(map[7] = "seven");
  for (int id = 100; id < 10'000; ++id) map[id];
  for (int id = 100; id < 10'000; ++id) map.erase(id);
  EXPECT_EQ(map.get(7), first);
  EXPECT_EQ(map.at(7), "seven");
  EXPECT_EQ(map.get(100), nullptr);
}

TEST(IdMap, RefusesIdsThatNobodyGave) {
  IdMap<int> map;
  EXPECT_THROW(map[-1], std::out_of_range);
  EXPECT_THROW(map[IdMap<int>::kMaxId + 1], std::out_of_range);
  EXPECT_THROW(map.at(3), std::out_of_range);
  EXPECT_TRUE(map.empty());
  map[IdMap<int>::kMaxId] = 1;
  EXPECT_EQ(map.begin()->first, IdMap<int>::kMaxId);
}

}  // namespace
}  // namespace rumi
