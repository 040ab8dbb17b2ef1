// SPDX-License-Identifier: BSD-3-Clause
#include "slam/optimization/reduced_solver.h"

#include <Eigen/Cholesky>
#include <vector>

namespace rumi {
namespace {

constexpr double kDenseShare = 1.0 / 8;  // share of blocks that may differ from zero; with more, a sparse factor is no
                                         // faster than a dense one
constexpr int kDenseSize = 100;          // blocks; in a system up to this size, a sparse factor is no faster either
constexpr int kWorn = 20;                // iterations of one solution; if they are more, making a new factor costs less
constexpr int kMost = 100;               // iterations of one solution, at most
constexpr double kTolerance = 1e-6;      // residual / right side at which the iterations end, in the preconditioner's
                                         // norm

bool solve_directly(const BlockMatrix& matrix, const Eigen::VectorXd& right, Eigen::VectorXd* solution) {
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(right.size(), right.size());
  for (int r = 0; r < matrix.size(); ++r)
    for (const BlockMatrix::Entry& entry : matrix.row(r)) dense.block<6, 6>(6 * r, 6 * entry.column) = entry.block;
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(dense);
  if (factor.info() != Eigen::Success) return false;
  *solution = factor.solve(right);
  return solution->allFinite();
}

}  // namespace

bool ReducedSolver::factorize(const BlockMatrix& matrix) {
  size_ = matrix.size();
  is_dense_ = size_ <= kDenseSize || matrix.filled() > kDenseShare;
  scale_.resize(6 * size_);
  for (int r = 0; r < size_; ++r)
    scale_.segment<6>(6 * r) = matrix.diagonal(r).diagonal().cwiseSqrt().cwiseInverse().cast<float>();
  if (!is_dense_) return sparse_.compute(matrix, scale_);
  dense_.setZero(6 * size_, 6 * size_);
  for (int r = 0; r < size_; ++r)
    for (const BlockMatrix::Entry& entry : matrix.row(r))
      dense_.block<6, 6>(6 * r, 6 * entry.column) = BlockFactor::scaled(r, entry, scale_);
  dense_.diagonal().array() += BlockFactor::kRounding;
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXf>> in_place(dense_);
  return in_place.info() == Eigen::Success;
}

Eigen::VectorXd ReducedSolver::precondition(const Eigen::VectorXd& residual) const {
  Eigen::VectorXf x = residual.cast<float>().cwiseProduct(scale_);
  if (is_dense_) {
    dense_.triangularView<Eigen::Lower>().solveInPlace(x);
    dense_.triangularView<Eigen::Lower>().transpose().solveInPlace(x);
  } else {
    sparse_.solve_in_place(&x);
  }
  return x.cwiseProduct(scale_).cast<double>();
}

bool ReducedSolver::iterate(const BlockMatrix& matrix, const Eigen::VectorXd& right, Eigen::VectorXd* solution) {
  solution->setZero(right.size());
  Eigen::VectorXd residual = right, z = precondition(residual), direction = z, product;
  double rz = residual.dot(z);
  const double enough = kTolerance * kTolerance * rz;
  for (int i = 0; i < kMost && rz > enough; ++i) {
    is_worn_ = i > kWorn;
    matrix.multiply(direction, &product);
    const double curvature = direction.dot(product);
    if (!(curvature > 0)) return false;
    const double length = rz / curvature;
    *solution += length * direction;
    residual -= length * product;
    z = precondition(residual);
    const double rz_next = residual.dot(z);
    direction = z + rz_next / rz * direction;
    rz = rz_next;
  }
  return rz <= enough;
}

bool ReducedSolver::solve(const BlockMatrix& matrix, const Eigen::VectorXd& right, Eigen::VectorXd* solution) {
  if (matrix.size() <= kSmall) return solve_directly(matrix, right, solution);
  if (!is_worn_ && size_ == matrix.size() && iterate(matrix, right, solution)) return solution->allFinite();
  is_worn_ = !factorize(matrix);
  return !is_worn_ && iterate(matrix, right, solution) && solution->allFinite();
}

}  // namespace rumi
