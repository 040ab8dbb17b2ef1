// SPDX-License-Identifier: BSD-3-Clause
#include "slam/numeric/median.h"

#include <gtest/gtest.h>

#include <cstdint>

namespace rumi {
namespace {

template <class T>
T median_of(std::vector<T> values) {
  return median(&values);
}

TEST(Median, IsTheMiddleValueInWhateverOrderTheyCome) {
  EXPECT_EQ(median_of<double>({7.5}), 7.5);
  EXPECT_EQ(median_of<double>({3, 1, 2}), 2);
  EXPECT_EQ(median_of<double>({1e300, -1e300, 0.25, 4, -3}), 0.25);
  EXPECT_EQ(median_of<int64_t>({33'334, 33'333, 1'000'000, 33'333, 33'334}), 33'334);
}

TEST(Median, OfAnEvenNumberIsTheUpperOfTheTwoInTheMiddle) {
  EXPECT_EQ(median_of<double>({1, 2}), 2);
  EXPECT_EQ(median_of<int>({4, 1, 3, 2}), 3);
  EXPECT_EQ(median_of<int>({5, 5, 1, 1}), 5);
}

TEST(Median, KeepsAllTheValues) {
  std::vector<int> values{9, 2, 7, 2, 5, 1};
  median(&values);
  std::sort(values.begin(), values.end());
  EXPECT_EQ(values, (std::vector<int>{1, 2, 2, 5, 7, 9}));
}

}  // namespace
}  // namespace rumi
