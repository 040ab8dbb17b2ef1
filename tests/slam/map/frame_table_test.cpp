// SPDX-License-Identifier: BSD-3-Clause
#include "slam/map/frame_table.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <stdexcept>
#include <thread>

namespace rumi {
namespace {

FramePose frame(int64_t utime_us, int reference, int64_t revision = 0) {
  return {utime_us, reference, SE3(), revision};
}

void expect_same(const FrameTable& table, const std::map<int64_t, int>& like) {
  ASSERT_EQ(table.size(), like.size());
  ASSERT_EQ(table.empty(), like.empty());
  auto expected = like.begin();
  for (const auto& [utime_us, found] : table) {
    ASSERT_EQ(utime_us, expected->first);
    ASSERT_EQ(found.reference_keyframe, expected->second);
    ++expected;
  }
  auto backwards = table.end();
  for (auto it = like.rbegin(); it != like.rend(); ++it) ASSERT_EQ((--backwards)->first, it->first);
  ASSERT_EQ(backwards, table.begin());
}

TEST(FrameTable, IsUsedAsAMapOfTheStandard) {
  std::mt19937 rng(3);
  FrameTable table;
  std::map<int64_t, int> like;
  for (int step = 0; step < 5000; ++step) {
    const int64_t utime_us = step % 3 == 0 ? static_cast<int64_t>(rng() % 4000) : 1000 + step;
    const int reference = static_cast<int>(rng() % 50);
    if (step % 1000 == 999) {
      table.erase_from(utime_us);
      like.erase(like.lower_bound(utime_us), like.end());
    } else {
      table.set(frame(utime_us, reference));
      like[utime_us] = reference;
    }
    if (step % 500 < 2) expect_same(table, like);
    const int64_t asked = static_cast<int64_t>(rng() % 7000);
    const auto at = table.lower_bound(asked);
    const auto expected = like.lower_bound(asked);
    ASSERT_EQ(at == table.end(), expected == like.end());
    if (expected != like.end()) {
      ASSERT_EQ(at->first, expected->first);
    }
    ASSERT_EQ(table.contains(asked), like.contains(asked));
  }
  expect_same(table, like);
  EXPECT_THROW(table.at(-5), std::out_of_range);
}

TEST(FrameTable, ListsWhatChangedAfterARevision) {
  FrameTable table;
  for (int i = 0; i < 1000; ++i) table.set(frame(i, 0, i));
  table.set(frame(5, 0, 2000));
  std::vector<int64_t> changed;
  table.for_each_after(997, [&](const FramePose& f) { changed.push_back(f.utime_us); });
  EXPECT_EQ(changed, (std::vector<int64_t>{5, 998, 999}));
  table.change_all([](FramePose* f) { f->revision = 3000; });
  int all = 0;
  table.for_each_after(2999, [&](const FramePose&) { ++all; });
  EXPECT_EQ(all, 1000);
}

TEST(FrameTable, CopiesShareWhatNeitherHasChanged) {
  FrameTable table;
  for (int i = 0; i < 1000; ++i) table.set(frame(i, 0));
  const FrameTable copy = table;
  EXPECT_EQ(copy.get(700), table.get(700));
  table.set(frame(700, 1));
  EXPECT_EQ(copy.at(700).reference_keyframe, 0);
  EXPECT_EQ(copy.get(10), table.get(10)) << "of another block";
}

// map_server's building thread reads a copy while the submap goes on. Run it under ThreadSanitizer.
TEST(FrameTable, ACopyIsReadInAnotherThreadWhileTheTableChanges) {
  FrameTable table;
  for (int i = 0; i < 2000; ++i) table.set(frame(i, 0));
  int sum = 0;
  std::thread reader([copy = table, &sum]() mutable {
    for (const auto& [utime_us, f] : copy) sum += f.reference_keyframe;
    copy = {};
  });
  for (int i = 0; i < 2000; ++i) table.set(frame(i, 1));
  reader.join();
  EXPECT_EQ(sum, 0);
}

}  // namespace
}  // namespace rumi
