// SPDX-License-Identifier: BSD-3-Clause
#include "slam/optimization/reduced_solver.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

namespace rumi {
namespace {

// Returns a positive definite matrix in which each row has `reach` blocks on either side of the diagonal.
BlockMatrix band(int size, int reach, unsigned seed) {
  std::vector<std::vector<int>> columns(size);
  for (int r = 0; r < size; ++r)
    for (int c = std::max(0, r - reach); c <= r; ++c) columns[r].push_back(c);
  BlockMatrix matrix(columns);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int r = 0; r < size; ++r)
    for (BlockMatrix::Entry& entry : matrix.row(r))
      entry.block = Matrix6d::NullaryExpr([&](Eigen::Index, Eigen::Index) { return uniform(random); });
  for (int r = 0; r < size; ++r) {
    const Matrix6d block = matrix.diagonal(r);
    matrix.diagonal(r) = block * block.transpose() + 4.0 * (2 * reach + 1) * Matrix6d::Identity();
  }
  return matrix;
}

Eigen::MatrixXd to_dense(const BlockMatrix& matrix) {
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(6 * matrix.size(), 6 * matrix.size());
  for (int r = 0; r < matrix.size(); ++r)
    for (const BlockMatrix::Entry& entry : matrix.row(r)) {
      dense.block<6, 6>(6 * r, 6 * entry.column) = entry.block;
      dense.block<6, 6>(6 * entry.column, 6 * r) = entry.block.transpose();
    }
  return dense;
}

Eigen::VectorXd some_vector(int size) {
  return Eigen::VectorXd::NullaryExpr(6 * size, [](Eigen::Index i) { return std::sin(1.0 + 0.7 * i); });
}

TEST(BlockMatrix, MultipliesAsTheWholeMatrix) {
  const BlockMatrix matrix = band(9, 3, 1);
  const Eigen::VectorXd x = some_vector(9);
  Eigen::VectorXd y;
  matrix.multiply(x, &y);
  EXPECT_LT((y - to_dense(matrix) * x).norm(), 1e-12 * y.norm());
  EXPECT_DOUBLE_EQ(matrix.filled(), (9 + 2 * (8 + 7 + 6)) / 81.0);
}

// Solves small, dense and sparse systems: each of them twice, then another one of the same size.
TEST(ReducedSolver, SolvesSystemsOfAllSizesOneAfterAnother) {
  ReducedSolver solver;
  for (const auto& [size, reach] :
       {std::pair{5, 4}, {ReducedSolver::kSmall, 9}, {ReducedSolver::kSmall + 1, 9}, {90, 89}, {150, 4}, {150, 40}}) {
    for (const unsigned seed : {1U, 1U, 2U}) {
      const BlockMatrix matrix = band(size, reach, seed);
      const Eigen::VectorXd right = some_vector(size);
      Eigen::VectorXd solution;
      ASSERT_TRUE(solver.solve(matrix, right, &solution));
      EXPECT_LT((to_dense(matrix) * solution - right).norm(), 2e-3 * right.norm()) << size << " " << reach;
    }
  }
}

TEST(ReducedSolver, RefusesWhatIsNotPositiveDefiniteOrNotFiniteAndRecovers) {
  for (const int size : {10, 100, 200}) {
    ReducedSolver solver;
    const BlockMatrix good = band(size, 3, 1);
    BlockMatrix negative = good, hollow = good;
    negative.diagonal(4) *= -1;
    hollow.diagonal(4)(2, 2) = std::numeric_limits<double>::quiet_NaN();
    const Eigen::VectorXd right = some_vector(size);
    Eigen::VectorXd solution;
    EXPECT_FALSE(solver.solve(negative, right, &solution)) << size;
    EXPECT_FALSE(solver.solve(hollow, right, &solution)) << size;
    ASSERT_TRUE(solver.solve(good, right, &solution)) << size;
    EXPECT_FALSE(solver.solve(negative, right, &solution)) << size;
    EXPECT_FALSE(solver.solve(hollow, right, &solution)) << size;
    ASSERT_TRUE(solver.solve(good, right, &solution)) << size;
    EXPECT_LT((to_dense(good) * solution - right).norm(), 2e-3 * right.norm());
  }
}

}  // namespace
}  // namespace rumi
