// SPDX-License-Identifier: BSD-3-Clause
#include "slam/optimization/block_factor.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <limits>
#include <random>
#include <utility>
#include <vector>

namespace rumi {
namespace {

// A positive definite matrix like that of a drive that comes back: a band, and blocks anywhere.
BlockMatrix drive(int size, int loops, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<std::vector<int>> columns(size);
  for (int r = 0; r < size; ++r)
    for (int c = std::max(0, r - 3); c <= r; ++c) columns[r].push_back(c);
  for (int i = 0; i < loops; ++i) {
    const int r = static_cast<int>(random() % size);
    if (const int c = static_cast<int>(random() % (r + 1));
        std::find(columns[r].begin(), columns[r].end(), c) == columns[r].end())
      columns[r].insert(std::upper_bound(columns[r].begin(), columns[r].end(), c), c);
  }
  BlockMatrix matrix(columns);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<double> sum(size, 0);
  for (int r = 0; r < size; ++r)
    for (BlockMatrix::Entry& entry : matrix.row(r)) {
      entry.block = Matrix6d::NullaryExpr([&](Eigen::Index, Eigen::Index) { return uniform(random); });
      sum[r] += 6;
      sum[entry.column] += 6;
    }
  for (int r = 0; r < size; ++r) matrix.diagonal(r) = sum[r] * Matrix6d::Identity();
  return matrix;
}

Eigen::VectorXf scale_of(const BlockMatrix& matrix) {
  Eigen::VectorXf scale(6 * matrix.size());
  for (int r = 0; r < matrix.size(); ++r)
    scale.segment<6>(6 * r) = matrix.diagonal(r).diagonal().cwiseSqrt().cwiseInverse().cast<float>();
  return scale;
}

TEST(BlockFactor, SolvesWhatABandWithLoopsSays) {
  for (const auto& [size, loops] : {std::pair{1, 0}, {2, 0}, {40, 0}, {40, 15}, {300, 0}, {300, 60}, {300, 3000}}) {
    const BlockMatrix matrix = drive(size, loops, 5);
    const Eigen::VectorXf scale = scale_of(matrix);
    BlockFactor factor;
    ASSERT_TRUE(factor.compute(matrix, scale)) << size << " " << loops;
    const Eigen::VectorXd wanted = Eigen::VectorXd::NullaryExpr(
        6 * size, [](Eigen::Index i) { return std::sin(1.0 + 0.7 * static_cast<double>(i)); });
    Eigen::VectorXd right;
    matrix.multiply(wanted, &right);
    Eigen::VectorXf x = right.cast<float>().cwiseProduct(scale);
    factor.solve_in_place(&x);
    EXPECT_LT((x.cwiseProduct(scale).cast<double>() - wanted).norm(), 1e-3 * wanted.norm()) << size << " " << loops;
  }
}

TEST(BlockFactor, OneAfterAnotherOfOtherSizes) {
  BlockFactor factor;
  for (const int size : {100, 7, 150}) {
    const BlockMatrix matrix = drive(size, size / 4, 1);
    ASSERT_TRUE(factor.compute(matrix, scale_of(matrix)));
    Eigen::VectorXf x = Eigen::VectorXf::Ones(6 * size);
    factor.solve_in_place(&x);
    EXPECT_TRUE(x.allFinite());
  }
}

TEST(BlockFactor, RefusesWhatIsNotPositiveDefiniteOrNotFinite) {
  BlockMatrix negative = drive(50, 9, 2), hollow = negative;
  const Eigen::VectorXf scale = scale_of(negative);
  negative.diagonal(20) *= -1;
  hollow.diagonal(20)(2, 2) = std::numeric_limits<double>::quiet_NaN();
  BlockFactor factor;
  EXPECT_FALSE(factor.compute(negative, scale));
  EXPECT_FALSE(factor.compute(hollow, scale));
}

}  // namespace
}  // namespace rumi
