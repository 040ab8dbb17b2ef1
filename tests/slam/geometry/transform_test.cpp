// SPDX-License-Identifier: BSD-3-Clause
#include "slam/geometry/transform.h"

#include <gtest/gtest.h>

#include <random>

namespace rumi {
namespace {

SE3 random_pose(std::mt19937& rng) {
  std::uniform_real_distribution<double> u(-1, 1);
  Vector6d twist;
  for (int i = 0; i < 6; ++i) twist[i] = 1.5 * u(rng);
  return SE3::exp(twist);
}

TEST(Transform, ExpAndLogAreInverse) {
  std::mt19937 rng(1);
  for (int i = 0; i < 100; ++i) {
    const SE3 pose = random_pose(rng);
    const SE3 back = SE3::exp(pose.log());
    EXPECT_LT((pose * back.inverse()).log().norm(), 1e-9);
  }
  Vector6d tiny;
  tiny << 1e-9, 2e-9, -1e-9, 3e-10, 1e-10, -2e-10;
  EXPECT_LT((SE3::exp(tiny).log() - tiny).norm(), 1e-15);
}

TEST(Transform, CompositionFollowsTheNames) {
  std::mt19937 rng(2);
  const SE3 c_from_b = random_pose(rng), b_from_a = random_pose(rng);
  const Eigen::Vector3d p_a(0.3, -2, 5);
  EXPECT_LT(((c_from_b * b_from_a) * p_a - c_from_b * (b_from_a * p_a)).norm(), 1e-12);
  EXPECT_LT((c_from_b.inverse() * (c_from_b * p_a) - p_a).norm(), 1e-12);
  EXPECT_LT((c_from_b * c_from_b.center()).norm(), 1e-12);
}

TEST(Transform, SimilarityMovesCamerasAndPointsAlike) {
  std::mt19937 rng(3);
  const SE3 rigid = random_pose(rng);
  const Sim3 map_from_submap(2.5, rigid.rotation, rigid.translation);
  const SE3 cam_from_submap = random_pose(rng);
  const Eigen::Vector3d p_submap(1, 2, 3);
  const SE3 cam_from_map = map_from_submap.transform_camera(cam_from_submap);
  // The camera sees the point in the same direction, at the scaled distance.
  EXPECT_LT((cam_from_map * (map_from_submap * p_submap) - 2.5 * (cam_from_submap * p_submap)).norm(), 1e-12);
  EXPECT_LT((map_from_submap.inverse() * (map_from_submap * p_submap) - p_submap).norm(), 1e-12);
}

TEST(Transform, SimilarityStepsDoNotMix) {
  std::mt19937 rng(4);
  const Eigen::Vector3d pivot(4, -5, 6);
  const SE3 rigid = random_pose(rng), other = random_pose(rng);
  const Sim3 from(2.5, rigid.rotation, rigid.translation), to(0.4, other.rotation, other.translation);
  const Sim3 there = from.plus(to.minus(from, pivot), pivot);
  EXPECT_NEAR(there.scale, to.scale, 1e-12);
  EXPECT_LT(there.rotation.angularDistance(to.rotation), 1e-7);
  EXPECT_LT((there.translation - to.translation).norm(), 1e-12);
  // Turning and scaling about the pivot leave its image where it was.
  Vector7d turn_and_scale;
  turn_and_scale << 0.1, 0.2, -0.3, 0, 0, 0, 0.5;
  const Sim3 turned = from.plus(turn_and_scale, pivot);
  EXPECT_LT((turned * pivot - from * pivot).norm(), 1e-12);
  EXPECT_LT((turned.minus(from, pivot) - turn_and_scale).norm(), 1e-12);
}

TEST(Transform, LeftJacobianIsTheDerivative) {
  const Eigen::Vector3d w(0.4, -0.9, 0.7), d(1e-6, -2e-6, 3e-6);
  const Eigen::Vector3d moved = so3_log(so3_exp(w + d) * so3_exp(w).conjugate());
  EXPECT_LT((moved - so3_left_jacobian(w) * d).norm(), 1e-11);
}

}  // namespace
}  // namespace rumi
