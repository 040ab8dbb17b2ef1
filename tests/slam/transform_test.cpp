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

}  // namespace
}  // namespace rumi
