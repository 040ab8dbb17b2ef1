// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/SparseCholesky>

#include "slam/optimization/block_matrix.h"

namespace rumi {

// Solves the positive definite systems of a bundle adjustment, each of which differs a little from the one before. It
// factors a small one. It solves a larger one by conjugate gradients (Hestenes and Stiefel, 1952); their preconditioner
// is the factor, in single precision, of an earlier system, for as long as that converges quickly.
class ReducedSolver {
 public:
  static constexpr int kSmall = 60;  // blocks: a system up to this size is factored each time

  // Returns false if the system is not positive definite or not finite.
  bool solve(const BlockMatrix& matrix, const Eigen::VectorXd& right, Eigen::VectorXd* solution);

 private:
  bool factorize(const BlockMatrix& matrix);
  Eigen::VectorXd precondition(const Eigen::VectorXd& residual) const;
  // Returns false if kMost iterations were not enough.
  bool iterate(const BlockMatrix& matrix, const Eigen::VectorXd& right, Eigen::VectorXd* solution);

  int size_ = 0;           // blocks of the factored matrix
  bool is_worn_ = true;    // the factor took many iterations
  bool is_dense_ = true;   // the factor is dense_; else sparse_
  Eigen::VectorXf scale_;  // 1 / sqrt(diagonal of the factored matrix)
  Eigen::MatrixXf dense_;  // in its lower half
  Eigen::SimplicialLLT<Eigen::SparseMatrix<float>> sparse_;
};

}  // namespace rumi
