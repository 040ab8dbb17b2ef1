// SPDX-License-Identifier: BSD-3-Clause
#include "slam/optimization/block_matrix.h"

namespace rumi {

BlockMatrix::BlockMatrix(const std::vector<std::vector<int>>& columns) : rows_(columns.size()) {
  for (size_t r = 0; r < rows_.size(); ++r) {
    rows_[r].reserve(columns[r].size());
    for (int column : columns[r]) rows_[r].push_back({column, Matrix6d::Zero()});
  }
}

double BlockMatrix::filled() const {
  size_t blocks = 0;
  for (const auto& row : rows_) blocks += row.size();
  const auto n = static_cast<double>(rows_.size());
  return (2 * static_cast<double>(blocks) - n) / (n * n);
}

void BlockMatrix::set_zero() {
  for (auto& row : rows_)
    for (Entry& entry : row) entry.block.setZero();
}

void BlockMatrix::multiply(const Eigen::VectorXd& x, Eigen::VectorXd* y) const {
  y->setZero(x.size());
  for (int r = 0; r < size(); ++r) {
    const Vector6d x_r = x.segment<6>(6 * r);
    Vector6d sum = diagonal(r) * x_r;
    for (size_t i = 0; i + 1 < rows_[r].size(); ++i) {
      const Entry& entry = rows_[r][i];
      sum.noalias() += entry.block * x.segment<6>(6 * entry.column);
      y->segment<6>(6 * entry.column).noalias() += entry.block.transpose() * x_r;
    }
    y->segment<6>(6 * r) += sum;
  }
}

}  // namespace rumi
