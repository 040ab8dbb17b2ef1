// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "slam/optimization/block_factor.h"
#include "slam/optimization/block_matrix.h"

namespace rumi {

// Solves the positive definite systems of a bundle adjustment, each of which differs little from the one before. A
// small system is factored. A larger one is solved by conjugate gradients (Hestenes and Stiefel, 1952). Their
// preconditioner is the factor, in single precision, of an earlier system, as long as they converge quickly with it.
class ReducedSolver {
 public:
  static constexpr int kSmall = 60;  // blocks; a system up to this size is factored each time

  // Returns false if the system cannot be solved: it is not positive definite, not finite, or the conjugate gradients
  // do not converge.
  bool solve(const BlockMatrix& matrix, const Eigen::VectorXd& right, Eigen::VectorXd* solution);

 private:
  bool factorize(const BlockMatrix& matrix);
  Eigen::VectorXd precondition(const Eigen::VectorXd& residual) const;
  // Solves by conjugate gradients. Returns false if they do not converge in kMost iterations.
  bool iterate(const BlockMatrix& matrix, const Eigen::VectorXd& right, Eigen::VectorXd* solution);

  int size_ = 0;           // size of the factored matrix, in rows of 6 x 6 blocks
  bool is_worn_ = true;    // true: a new factor is due, because the last solution took many iterations
  bool is_dense_ = true;   // true: the factor is dense_; false: it is sparse_
  Eigen::VectorXf scale_;  // 1 / sqrt(diagonal of the factored matrix)
  Eigen::MatrixXf dense_;  // the factor is its lower half
  BlockFactor sparse_;
};

}  // namespace rumi
