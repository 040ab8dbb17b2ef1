// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <limits>

#include "slam/geometry/resection.h"
#include "slam/optimization/pose_optimizer.h"
#include "synthetic_scene.h"

namespace rumi {
namespace {

std::vector<PointObservation> observe(SyntheticScene& scene, const SE3& pose, int count, double noise_px,
                                      double outliers) {
  std::vector<PointObservation> observations;
  for (const Eigen::Vector3d& p : scene.cloud(count)) {
    Eigen::Vector2d pixel = test_camera().project_undistorted(pose * p) + scene.noise(noise_px);
    if (scene.uniform(0, 1) < outliers) pixel = {scene.uniform(0, 640), scene.uniform(0, 480)};
    observations.push_back({p, pixel, 1.0});
  }
  return observations;
}

TEST(OptimizePose, ConvergesWithNoiseAndOutliers) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SyntheticScene scene(seed);
    const SE3 truth = SyntheticScene::pose(0.2, -0.1, 0.3, 0.1, 0.05);
    const auto observations = observe(scene, truth, 200, 0.7, 0.25);
    const SE3 start = SyntheticScene::pose(0.1, 0, 0.2, 0.06, 0.02);
    const PoseResult r = optimize_pose(test_camera(), start, observations);
    ASSERT_TRUE(r.converged);
    EXPECT_LT(rotation_error_deg(r.cam_from_submap, truth), 0.15);
    EXPECT_LT((r.cam_from_submap.center() - truth.center()).norm(), 0.01);
    EXPECT_GT(r.inliers, 120);
    EXPECT_LT(r.rmse_px, 1.3);
  }
}

TEST(OptimizePose, SaysWhenThereIsTooLittle) {
  SyntheticScene scene(1);
  const auto observations = observe(scene, SE3(), 5, 0.5, 0);
  EXPECT_FALSE(optimize_pose(test_camera(), SE3(), observations).converged);
  EXPECT_FALSE(optimize_pose(test_camera(), SE3(), {}).converged);
  // The same point over and over fixes no pose, but must not break anything.
  const std::vector<PointObservation> same(20, observations.front());
  EXPECT_TRUE(optimize_pose(test_camera(), SE3(), same).cam_from_submap.is_finite());
}

TEST(OptimizePose, NonFiniteObservationsAreOutliers) {
  SyntheticScene scene(2);
  auto observations = observe(scene, SE3(), 100, 0.5, 0);
  observations[3].pixel.x() = std::numeric_limits<double>::quiet_NaN();
  observations[4].point.z() = std::numeric_limits<double>::quiet_NaN();
  const PoseResult r = optimize_pose(test_camera(), SE3(), observations);
  EXPECT_TRUE(r.cam_from_submap.is_finite());
}

TEST(Resect, FindsThePoseFromNowhere) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SyntheticScene scene(seed);
    const SE3 truth = SyntheticScene::pose(1.0, -0.5, -1.0, 0.5, 0.2);
    const auto observations = observe(scene, truth, 120, 0.7, 0.5);
    const auto r = resect(test_camera(), observations);
    ASSERT_TRUE(r);
    EXPECT_LT(rotation_error_deg(r->cam_from_submap, truth), 0.3);
    EXPECT_LT((r->cam_from_submap.center() - truth.center()).norm(), 0.03);
  }
}

TEST(Resect, RefusesNonsense) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SyntheticScene scene(seed);
    EXPECT_FALSE(resect(test_camera(), observe(scene, SE3(), 100, 0.7, 1.0)));
  }
  EXPECT_FALSE(resect(test_camera(), {}));
}

}  // namespace
}  // namespace rumi
