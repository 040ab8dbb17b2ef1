// SPDX-License-Identifier: BSD-3-Clause
#include "slam/numeric/union_find.h"

#include <gtest/gtest.h>

namespace rumi {
namespace {

TEST(UnionFind, TheLowestStandsForAGroup) {
  UnionFind groups(5);
  EXPECT_EQ(groups.add(), 5u);
  for (size_t i = 0; i < 6; ++i) EXPECT_EQ(groups.find(i), i) << "alone at first";
  groups.unite(4, 5);
  groups.unite(5, 2);
  EXPECT_EQ(groups.find(4), 2u);
  groups.unite(0, 1);
  groups.unite(1, 4);
  for (const size_t together : {0, 1, 2, 4, 5}) EXPECT_EQ(groups.find(together), 0u) << together;
  EXPECT_EQ(groups.find(3), 3u);
}

}  // namespace
}  // namespace rumi
