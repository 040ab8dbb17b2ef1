// SPDX-License-Identifier: BSD-3-Clause
#include "slam/numeric/median.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <random>

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

// The median scatters by its standard error, even if some of the values are wild.
TEST(RobustMean, KnowsHowWellItIsKnown) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal(5, 2);
  double squares = 0, sigmas = 0;
  constexpr int kRuns = 400, kValues = 101, kWild = 10;
  for (int run = 0; run < kRuns; ++run) {
    std::vector<double> values;
    for (int i = 0; i < kValues; ++i) values.push_back(normal(random));
    for (int i = 0; i < kWild; ++i) values[i] = i % 2 ? 1e6 : -1e6;
    const RobustMean mean = robust_mean(&values, kValues);
    squares += (mean.value - 5) * (mean.value - 5);
    sigmas += mean.sigma;
  }
  const double scatter = std::sqrt(squares / kRuns);
  EXPECT_NEAR(sigmas / kRuns, scatter, 0.2 * scatter);
}

TEST(RobustMean, LeavesTheDeviations) {
  std::vector<double> values = {1, 2, 10};
  EXPECT_EQ(robust_mean(&values, 3).value, 2);
  std::sort(values.begin(), values.end());
  EXPECT_EQ(values, (std::vector<double>{0, 1, 8}));
}

}  // namespace
}  // namespace rumi
