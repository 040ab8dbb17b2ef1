// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "slam/optimization/block_matrix.h"

namespace rumi {

// The Cholesky factor, in single precision, of a sparse positive definite matrix of 6x6 blocks. A column of blocks is
// computed at once from the columns before it (left-looking: Davis, "Direct Methods for Sparse Linear Systems", 2006,
// section 4.8), in an order of few new blocks (approximate minimum degree, Amestoy et al., 1996).
class BlockFactor {
 public:
  using Block = Eigen::Matrix<float, 6, 6>;
  // Returns a block of the row of scale * matrix * scale.
  static Block scaled(int row, const BlockMatrix::Entry& entry, const Eigen::VectorXf& scale) {
    return scale.segment<6>(6 * row).asDiagonal() * entry.block.cast<float>() *
           scale.segment<6>(6 * entry.column).asDiagonal();
  }

  // Factors scale * matrix * scale with kRounding added to its diagonal. `scale` should give it a unit diagonal.
  // Returns false if that is not positive definite.
  bool compute(const BlockMatrix& matrix, const Eigen::VectorXf& scale);
  // Solves for x in place; compute() must have succeeded.
  void solve_in_place(Eigen::VectorXf* x) const;

  // Rounding could make the matrix indefinite.
  static constexpr float kRounding = 1e-5F;

 private:
  using Panel = Eigen::Matrix<float, Eigen::Dynamic, 6>;
  struct Column {
    std::vector<int> rows;           // rows of blocks below the diagonal that may differ from zero, ascending
    Block diagonal = Block::Zero();  // lower triangular
    Panel below;                     // their blocks, one above the other
  };

  void order(const BlockMatrix& matrix);
  void find_rows(const std::vector<std::vector<int>>& rows_of);
  void fill(const BlockMatrix& matrix, const Eigen::VectorXf& scale);
  void subtract(const Column& from, size_t first, int column);
  bool finish(int column);

  std::vector<int> position_of_;  // by row of blocks in the matrix: its row in the factor
  std::vector<Column> columns_;
  std::vector<int> place_of_;  // scratch of compute(): by row of the factor, its place in the column at hand
  Panel product_;              // scratch of subtract()
};

}  // namespace rumi
