// SPDX-License-Identifier: BSD-3-Clause
#include "slam/map/removals.h"

#include <gtest/gtest.h>

#include <numeric>

namespace rumi {
namespace {

using Ids = std::vector<int>;

TEST(Removals, AreToldSinceARevision) {
  Removals removals;
  EXPECT_EQ(removals.since(0), Ids());
  removals.add(7, 1);
  removals.add(3, 2);
  removals.add(5, 2);
  removals.add(7, 4);  // id 7 had been added again
  EXPECT_EQ(removals.since(0), Ids({3, 5, 7}));
  EXPECT_EQ(removals.since(1), Ids({3, 5, 7}));
  EXPECT_EQ(removals.since(2), Ids({7}));
  EXPECT_EQ(removals.since(4), Ids());
}

TEST(Removals, WhatIsForgottenIsNotTold) {
  Removals removals;
  removals.add(7, 1);
  removals.add(3, 2);
  removals.forget(1);
  EXPECT_EQ(removals.since(0), std::nullopt);
  EXPECT_EQ(removals.since(1), Ids({3}));
  removals.forget(5);
  EXPECT_EQ(removals.since(4), std::nullopt);
  EXPECT_EQ(removals.since(5), Ids());
}

TEST(Removals, TheLatestAreRemembered) {
  Removals removals;
  const int n = static_cast<int>(10 * Removals::kMost);
  for (int i = 1; i <= n; ++i) removals.add(i, i);
  EXPECT_EQ(removals.since(0), std::nullopt);
  const int since = n - static_cast<int>(Removals::kMost) / 2 + 1;
  Ids latest(n - since);
  std::iota(latest.begin(), latest.end(), since + 1);
  EXPECT_EQ(removals.since(since), latest);
  EXPECT_EQ(removals.since(n - static_cast<int>(Removals::kMost) - 1), std::nullopt);
}

TEST(Removals, ManyAtOnceAreForgottenTogether) {
  Removals removals;
  const int n = static_cast<int>(Removals::kMost) + 5;
  for (int i = 0; i < n; ++i) removals.add(i, 3);
  EXPECT_EQ(removals.since(2), std::nullopt) << "some of revision 3 are gone";
  EXPECT_EQ(removals.since(3), Ids());
}

}  // namespace
}  // namespace rumi
