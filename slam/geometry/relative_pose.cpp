// SPDX-License-Identifier: BSD-3-Clause
#include "slam/geometry/relative_pose.h"

#include <Eigen/Cholesky>

namespace rumi {
namespace {

using Vector5d = Eigen::Matrix<double, 5, 1>;
using Matrix5d = Eigen::Matrix<double, 5, 5>;

constexpr double kHuber2 = 3.84;  // squared error in sigma^2 beyond which the loss is linear; 95 % of normal errors are
                                  // smaller

// A step is a rotation vector on the left and a move of the translation in the tangent plane of the unit sphere.
struct Tangent {
  Eigen::Matrix<double, 3, 2> basis;
  explicit Tangent(const Eigen::Vector3d& t) {
    basis.col(0) = t.unitOrthogonal();
    basis.col(1) = t.cross(basis.col(0));
  }
  SE3 move(const SE3& pose, const Vector5d& step) const {
    return {so3_exp(step.head<3>()) * pose.rotation, (pose.translation + basis * step.tail<2>()).normalized()};
  }
};

struct Equations {
  Matrix5d h = Matrix5d::Zero();
  Vector5d g = Vector5d::Zero();
  double cost = 0;
};

Equations linearize(const std::vector<Eigen::Vector2d>& first, const std::vector<Eigen::Vector2d>& second, double sigma,
                    const SE3& pose, const Tangent& tangent) {
  Equations n;
  const Eigen::Matrix3d r = pose.rotation.toRotationMatrix(), e = skew(pose.translation) * r;
  for (size_t i = 0; i < first.size(); ++i) {
    const Eigen::Vector3d a = first[i].homogeneous(), b = second[i].homogeneous(), turned = r * a;
    const Eigen::Vector3d line_b = e * a, line_a = e.transpose() * b;
    const double length2 = line_b.head<2>().squaredNorm() + line_a.head<2>().squaredNorm();
    if (!(length2 > 1e-18)) continue;
    const double scale = 1.0 / (sigma * std::sqrt(length2)), error = scale * b.dot(line_b), e2 = error * error;
    const double w = e2 > kHuber2 ? std::sqrt(kHuber2 / e2) : 1.0;
    n.cost += e2 > kHuber2 ? 2 * std::sqrt(kHuber2 * e2) - kHuber2 : e2;
    // The derivative of b . (t x (turned + step x turned)), with the lengths of the epipolar lines held fixed.
    Vector5d j;
    j.head<3>() = scale * turned.cross(b.cross(pose.translation));
    j.tail<2>() = scale * tangent.basis.transpose() * turned.cross(b);
    n.h.noalias() += w * j * j.transpose();
    n.g.noalias() += w * error * j;
  }
  return n;
}

}  // namespace

void refine_relative_pose(const std::vector<Eigen::Vector2d>& first, const std::vector<Eigen::Vector2d>& second,
                          double sigma, SE3* second_from_first) {
  constexpr int kIterations = 20;
  double lambda = 1e-4;
  Equations n = linearize(first, second, sigma, *second_from_first, Tangent(second_from_first->translation));
  for (int i = 0; i < kIterations && lambda < 1e6; ++i) {
    const Tangent tangent(second_from_first->translation);
    Matrix5d h = n.h;
    h.diagonal() += lambda * n.h.diagonal() + Vector5d::Constant(1e-9);
    const Vector5d step = -h.ldlt().solve(n.g);
    const SE3 moved = tangent.move(*second_from_first, step);
    if (!moved.is_finite()) return;
    const Equations next = linearize(first, second, sigma, moved, Tangent(moved.translation));
    if (!(next.cost < n.cost)) {
      lambda *= 10;
      continue;
    }
    const bool stalled = n.cost - next.cost < 1e-5 * n.cost;
    *second_from_first = moved;
    n = next;
    lambda = std::max(lambda * 0.1, 1e-9);
    if (stalled) return;
  }
}

}  // namespace rumi
