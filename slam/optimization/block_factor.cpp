// SPDX-License-Identifier: BSD-3-Clause
#include "slam/optimization/block_factor.h"

#include <Eigen/Cholesky>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <iterator>
#include <utility>

namespace rumi {

void BlockFactor::order(const BlockMatrix& matrix) {
  std::vector<Eigen::Triplet<float>> entries;
  for (int r = 0; r < matrix.size(); ++r)
    for (const BlockMatrix::Entry& entry : matrix.row(r)) {
      entries.emplace_back(r, entry.column, 1);
      if (entry.column != r) entries.emplace_back(entry.column, r, 1);
    }
  Eigen::SparseMatrix<float> pattern(matrix.size(), matrix.size());
  pattern.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> matrix_from_factor;
  Eigen::AMDOrdering<int>()(pattern, matrix_from_factor);
  position_of_.resize(matrix.size());
  for (int i = 0; i < matrix.size(); ++i) position_of_[matrix_from_factor.indices()[i]] = i;
}

// The rows of a column are its own and those of the columns whose first row it is.
void BlockFactor::find_rows(const std::vector<std::vector<int>>& rows_of) {
  const auto n = static_cast<int>(rows_of.size());
  columns_.assign(n, {});
  std::vector<std::vector<int>> children(n);
  std::vector<int> met(n, -1);
  for (int c = 0; c < n; ++c) {
    std::vector<int>& rows = columns_[c].rows;
    met[c] = c;
    const auto add = [&](const std::vector<int>& others) {
      for (int row : others)
        if (std::exchange(met[row], c) != c) rows.push_back(row);
    };
    add(rows_of[c]);
    for (int child : children[c]) add(columns_[child].rows);
    std::sort(rows.begin(), rows.end());
    if (!rows.empty()) children[rows.front()].push_back(c);
    columns_[c].below.setZero(static_cast<Eigen::Index>(6 * rows.size()), 6);
  }
}

// Subtracts what the earlier column, whose row `first` is `column`, takes from it.
void BlockFactor::subtract(const Column& from, size_t first, int column) {
  const auto begin = static_cast<Eigen::Index>(6 * first);
  const Eigen::Index n = from.below.rows() - begin;
  const Block factor = from.below.middleRows<6>(begin);
  product_.resize(std::max(product_.rows(), n), 6);
  for (int c = 0; c < 6; ++c) {
    auto sum = product_.col(c).head(n);
    sum = from.below.col(0).tail(n) * factor(c, 0);
    for (int k = 1; k < 6; ++k) sum += from.below.col(k).tail(n) * factor(c, k);
  }
  Column& to = columns_[column];
  to.diagonal -= product_.topRows<6>();
  for (size_t i = first + 1; i < from.rows.size(); ++i)
    to.below.middleRows<6>(6 * place_of_[from.rows[i]]) -=
        product_.middleRows<6>(static_cast<Eigen::Index>(6 * (i - first)));
}

bool BlockFactor::finish(int column) {
  Column& c = columns_[column];
  const Eigen::LLT<Block> llt(c.diagonal);
  if (llt.info() != Eigen::Success || !c.diagonal.allFinite()) return false;  // LLT accepts NaN
  c.diagonal = llt.matrixL();
  for (int k = 0; k < 6; ++k) {
    for (int i = 0; i < k; ++i) c.below.col(k) -= c.below.col(i) * c.diagonal(k, i);
    c.below.col(k) /= c.diagonal(k, k);
  }
  return true;
}

// Copies the matrix into the columns.
void BlockFactor::fill(const BlockMatrix& matrix, const Eigen::VectorXf& scale) {
  for (int r = 0; r < matrix.size(); ++r)
    for (const BlockMatrix::Entry& entry : matrix.row(r)) {
      const int row = position_of_[r], column = position_of_[entry.column];
      if (row == column) {
        columns_[row].diagonal = scaled(r, entry, scale) + kRounding * Block::Identity();
        continue;
      }
      Column& to = columns_[std::min(row, column)];
      const auto at = std::lower_bound(to.rows.begin(), to.rows.end(), std::max(row, column)) - to.rows.begin();
      if (row > column)
        to.below.middleRows<6>(6 * at) = scaled(r, entry, scale);
      else
        to.below.middleRows<6>(6 * at) = scaled(r, entry, scale).transpose();
    }
}

bool BlockFactor::compute(const BlockMatrix& matrix, const Eigen::VectorXf& scale) {
  const int n = matrix.size();
  order(matrix);
  std::vector<std::vector<int>> rows_of(n);
  for (int r = 0; r < n; ++r)
    for (const BlockMatrix::Entry& entry : matrix.row(r))
      if (const auto [column, row] = std::minmax(position_of_[r], position_of_[entry.column]); column != row)
        rows_of[column].push_back(row);
  find_rows(rows_of);
  fill(matrix, scale);
  // By row: the finished columns that have a block there and none between their diagonal and it that is not used yet.
  std::vector<std::vector<std::pair<int, size_t>>> next(n);
  place_of_.assign(n, 0);
  for (int c = 0; c < n; ++c) {
    for (size_t i = 0; i < columns_[c].rows.size(); ++i) place_of_[columns_[c].rows[i]] = static_cast<int>(i);
    for (const auto& [from, first] : std::exchange(next[c], {})) {
      const Column& earlier = columns_[from];
      subtract(earlier, first, c);
      if (first + 1 < earlier.rows.size()) next[earlier.rows[first + 1]].emplace_back(from, first + 1);
    }
    if (!finish(c)) return false;
    if (!columns_[c].rows.empty()) next[columns_[c].rows.front()].emplace_back(c, 0);
  }
  return true;
}

void BlockFactor::solve_in_place(Eigen::VectorXf* x) const {
  Eigen::VectorXf y(x->size()), part;
  for (size_t r = 0; r < position_of_.size(); ++r)
    y.segment<6>(6 * position_of_[r]) = x->segment<6>(static_cast<Eigen::Index>(6 * r));
  for (size_t c = 0; c < columns_.size(); ++c) {
    const Column& column = columns_[c];
    auto own = y.segment<6>(static_cast<Eigen::Index>(6 * c));
    column.diagonal.triangularView<Eigen::Lower>().solveInPlace(own);
    part.noalias() = column.below * own;
    for (size_t i = 0; i < column.rows.size(); ++i)
      y.segment<6>(6 * column.rows[i]) -= part.segment<6>(static_cast<Eigen::Index>(6 * i));
  }
  for (size_t c = columns_.size(); c-- > 0;) {
    const Column& column = columns_[c];
    auto own = y.segment<6>(static_cast<Eigen::Index>(6 * c));
    part.resize(column.below.rows());
    for (size_t i = 0; i < column.rows.size(); ++i)
      part.segment<6>(static_cast<Eigen::Index>(6 * i)) = y.segment<6>(6 * column.rows[i]);
    own.noalias() -= column.below.transpose() * part;
    column.diagonal.transpose().triangularView<Eigen::Upper>().solveInPlace(own);
  }
  for (size_t r = 0; r < position_of_.size(); ++r)
    x->segment<6>(static_cast<Eigen::Index>(6 * r)) = y.segment<6>(6 * position_of_[r]);
}

}  // namespace rumi
