// SPDX-License-Identifier: BSD-3-Clause
#include "slam/geometry/relative_pose.h"

#include <gtest/gtest.h>

#include "slam/geometry/rotation_fit.h"
#include "tests/slam/synthetic_scene.h"

namespace rumi {
namespace {

TEST(RelativePose, ComesBackFromARoughPose) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    SyntheticScene scene(seed);
    SE3 truth = SyntheticScene::pose(0.4, 0.1, 0.05, 0.05, -0.03);
    truth.translation.normalize();
    std::vector<Eigen::Vector2d> first, second;
    const double sigma = 0.5 / test_camera().fx;
    for (const Eigen::Vector3d& p : scene.cloud(300)) {
      const Eigen::Vector3d q = SyntheticScene::pose(0.4, 0.1, 0.05, 0.05, -0.03) * p;
      first.push_back(p.hnormalized() + sigma * scene.noise(1));
      second.push_back(q.hnormalized() + sigma * scene.noise(1));
    }
    SE3 pose = SE3(so3_exp({0.01, -0.02, 0.01}), Eigen::Vector3d::Zero()) * truth;
    pose.translation = (truth.translation + Eigen::Vector3d(0.1, -0.1, 0.1)).normalized();
    refine_relative_pose(first, second, sigma, &pose);
    EXPECT_LT(rotation_error_deg(pose, truth), 0.3) << seed;
    EXPECT_GT(pose.translation.dot(truth.translation), std::cos(0.07)) << seed;
    EXPECT_NEAR(pose.translation.norm(), 1, 1e-12);
  }
}

TEST(RelativePose, NothingToGoByLeavesThePose) {
  SE3 pose = SyntheticScene::pose(1, 0, 0, 0.1);
  const SE3 before = pose;
  refine_relative_pose({}, {}, 1e-3, &pose);
  EXPECT_LT((pose.translation - before.translation).norm(), 1e-12);
  EXPECT_LT(rotation_error_deg(pose, before), 1e-9);
}

TEST(CentralRotation, IsTheOneAmongMostOfTheOthers) {
  std::vector<Eigen::Quaterniond> rotations;
  for (const double angle : {2.0, 0.11, 0.1, 0.08, -1.5})
    rotations.emplace_back(Eigen::AngleAxisd(angle, Eigen::Vector3d(1, 2, 3).normalized()));
  EXPECT_EQ(central_rotation(rotations).coeffs(), rotations[2].coeffs());
  EXPECT_EQ(central_rotation({rotations[0]}).coeffs(), rotations[0].coeffs());
}

TEST(RotationFit, FindsTheTurnAmongAThirdOfWrongPairsAndMeasuresTheRest) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    SyntheticScene scene(seed);
    const SE3 truth = SyntheticScene::pose(0, 0, 0, 0.2, -0.1);
    std::vector<Eigen::Vector3d> a, b;
    for (const Eigen::Vector3d& p : scene.cloud(200)) {
      a.push_back(p);
      b.push_back(scene.uniform(0, 1) < 0.3 ? scene.cloud(1).front() : truth * p);
    }
    const auto fit = fit_rotation(a, b);
    ASSERT_TRUE(fit);
    EXPECT_LT(rotation_error_deg(SE3(fit->b_from_a, Eigen::Vector3d::Zero()), truth), 0.1);
    EXPECT_LT(fit->median_residual_rad, 1e-3);
  }
  EXPECT_FALSE(fit_rotation({{0, 0, 1}}, {{0, 0, 1}}));
}

}  // namespace
}  // namespace rumi
