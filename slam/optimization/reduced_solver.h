// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/SparseCholesky>

#include "slam/optimization/block_matrix.h"

namespace rumi {

// Solves the positive definite systems of a bundle adjustment, one after another, each a little different from the one
// before. A small one is factored. A larger one is solved by conjugate gradients (Hestenes and Stiefel, 1952); their
// preconditioner is the factor, in single precision, of an earlier one, for as long as that serves.
class ReducedSolver {
 public:
  static constexpr int kSmall = 60;  // blocks of a system that is factored each time

  // False when it cannot be solved: it is not positive definite, or not finite.
  bool solve(const BlockMatrix& matrix, const Eigen::VectorXd& right, Eigen::VectorXd* solution);

 private:
  bool factorize(const BlockMatrix& matrix);
  Eigen::VectorXd precondition(const Eigen::VectorXd& residual) const;
  // False when kMost iterations did not do.
  bool iterate(const BlockMatrix& matrix, const Eigen::VectorXd& right, Eigen::VectorXd* solution);

  int size_ = 0;           // blocks of what was factored
  bool is_worn_ = true;    // the factor took many iterations
  bool is_dense_ = true;   // which of the two it is
  Eigen::VectorXf scale_;  // one over the square root of the diagonal of what was factored
  Eigen::MatrixXf dense_;  // in its lower half
  Eigen::SimplicialLLT<Eigen::SparseMatrix<float>> sparse_;
};

}  // namespace rumi
