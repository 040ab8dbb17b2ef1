// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "slam/geometry/transform.h"

namespace rumi {

// A sparse symmetric matrix of 6x6 blocks with a fixed pattern. It stores the lower half.
class BlockMatrix {
 public:
  struct Entry {
    int column = 0;
    Matrix6d block;
  };

  // `columns`: for each row, the columns that have a block, ascending. The last one is the row itself.
  explicit BlockMatrix(const std::vector<std::vector<int>>& columns);

  int size() const { return static_cast<int>(rows_.size()); }  // number of rows of blocks
  // Returns the share of the blocks of the whole matrix that may differ from zero.
  double filled() const;
  void set_zero();
  std::vector<Entry>& row(int r) { return rows_[r]; }
  const std::vector<Entry>& row(int r) const { return rows_[r]; }
  Matrix6d& diagonal(int r) { return rows_[r].back().block; }
  const Matrix6d& diagonal(int r) const { return rows_[r].back().block; }
  // Computes *y = this * x.
  void multiply(const Eigen::VectorXd& x, Eigen::VectorXd* y) const;

 private:
  std::vector<std::vector<Entry>> rows_;
};

}  // namespace rumi
