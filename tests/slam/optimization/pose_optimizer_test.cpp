// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <limits>

#include "slam/optimization/pose_optimizer.h"
#include "slam/optimization/resection.h"
#include "tests/slam/synthetic_scene.h"

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

// Keypoints on edges slide to where they were expected, all by the same amount. Only keypoints on corners, and the
// direction across the edges, tell the truth.
TEST(OptimizePose, EdgesTellAcrossOnly) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    SyntheticScene scene(seed);
    const SE3 truth = SyntheticScene::pose(0.2, -0.1, 0.3, 0.1, 0.05);
    auto observations = observe(scene, truth, 200, 0.3, 0);
    for (size_t i = 0; i < observations.size(); ++i) {
      if (i % 4 == 0) continue;
      const EdgeNoise edge = edge_noise(scene, 0.3, scene.uniform(-0.2, 0.2), 6);
      observations[i].pixel += edge.error + Eigen::Vector2d(2, 0);
      observations[i].whitening = edge.whitening;
    }
    const PoseResult r = optimize_pose(test_camera(), truth, observations);
    for (auto& o : observations) o.whitening.setIdentity();
    const PoseResult blind = optimize_pose(test_camera(), truth, observations);
    const auto off = [&](const PoseResult& result) { return rotation_error_deg(result.cam_from_submap, truth); };
    EXPECT_LT(off(r), 0.07);
    EXPECT_LT(off(r), 0.5 * off(blind));
  }
}

TEST(OptimizePose, AWeightOfTwoIsTwoObservations) {
  SyntheticScene scene(4);
  const SE3 truth = SyntheticScene::pose(0.2, -0.1, 0.3, 0.1, 0.05);
  auto weighed = observe(scene, truth, 100, 0.7, 0.1);
  auto doubled = weighed;
  for (size_t i = 0; i < weighed.size(); i += 3) {
    weighed[i].weight = 2;
    doubled.push_back(doubled[i]);
  }
  const SE3 by_weight = optimize_pose(test_camera(), truth, weighed).cam_from_submap;
  const SE3 by_count = optimize_pose(test_camera(), truth, doubled).cam_from_submap;
  const SE3 equal = optimize_pose(test_camera(), truth, {doubled.begin(), doubled.begin() + 100}).cam_from_submap;
  EXPECT_LT((by_weight.center() - by_count.center()).norm(), 1e-6);
  EXPECT_GT((by_weight.center() - equal.center()).norm(), 1e-5);
}

TEST(OptimizePose, SaysWhenThereIsTooLittle) {
  SyntheticScene scene(1);
  const auto observations = observe(scene, SE3(), 5, 0.5, 0);
  EXPECT_FALSE(optimize_pose(test_camera(), SE3(), observations).converged);
  EXPECT_FALSE(optimize_pose(test_camera(), SE3(), {}).converged);
  // One point repeated determines no pose, but must not break anything.
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

// Returns the matches of points that both a view at `other` and one at `pose` see. In a share `wrong` of them, the
// pixels have nothing to do with each other.
EpipolarView epipolar_view(SyntheticScene& scene, const SE3& other, const SE3& pose, int count, double noise_px,
                           double wrong) {
  EpipolarView view{other, {}};
  for (const Eigen::Vector3d& p : scene.cloud(count)) {
    Eigen::Vector2d pixel = test_camera().project_undistorted(pose * p) + scene.noise(noise_px);
    if (scene.uniform(0, 1) < wrong) pixel = {scene.uniform(0, 640), scene.uniform(0, 480)};
    view.matches.push_back({test_camera().project_undistorted(other * p) + scene.noise(noise_px), pixel, 1.0});
  }
  return view;
}

// Returns landmarks in a corner of the image; the pixels of 30 % of them are off in the same direction.
std::vector<PointObservation> biased_corner(SyntheticScene& scene, const SE3& pose, int count) {
  std::vector<PointObservation> observations;
  for (Eigen::Vector3d p : scene.cloud(count)) {
    p.head<2>() = p.z() * Eigen::Vector2d(scene.uniform(0.3, 0.45), scene.uniform(0.2, 0.35));
    Eigen::Vector2d pixel = test_camera().project_undistorted(pose * p) + scene.noise(0.7);
    if (scene.uniform(0, 1) < 0.3) pixel += Eigen::Vector2d(1.5, -1.5);
    observations.push_back({p, pixel, 1.0});
  }
  return observations;
}

TEST(OptimizePose, EpipolarMatchesHoldTheRotationWhereLandmarksAreFew) {
  double error = 0, error_alone = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    SyntheticScene scene(seed);
    const SE3 truth = SyntheticScene::pose(0.2, -0.1, 0.1, 0.1, 0.05), other;
    const auto observations = biased_corner(scene, truth, 40);
    const std::vector<EpipolarView> views = {epipolar_view(scene, other, truth, 300, 0.7, 0.2)};
    const SE3 start = SyntheticScene::pose(0.15, -0.1, 0.1, 0.08, 0.04);
    const PoseResult alone = optimize_pose(test_camera(), start, observations);
    const PoseResult r = optimize_pose(test_camera(), start, observations, {}, views);
    ASSERT_TRUE(r.converged);
    EXPECT_LT(rotation_error_deg(r.cam_from_submap, truth), 0.3);
    EXPECT_LE(r.inliers, 40);
    error += rotation_error_deg(r.cam_from_submap, truth) / 20;
    error_alone += rotation_error_deg(alone.cam_from_submap, truth) / 20;
  }
  EXPECT_LT(error, 0.5 * error_alone);
}

TEST(OptimizePose, EpipolarMatchesThatSayNothingChangeNothing) {
  SyntheticScene scene(3);
  const SE3 truth = SyntheticScene::pose(0.2, 0, 0, 0.1);
  const auto observations = observe(scene, truth, 100, 0.7, 0);
  const PoseResult alone = optimize_pose(test_camera(), truth, observations);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const EpipolarView empty, not_finite{SE3(), {{{kNan, 1}, {1, 1}, 1.0}, {{1, 1}, {1, kNan}, 1.0}}};
  const PoseResult r = optimize_pose(test_camera(), truth, observations, {}, {empty, not_finite});
  EXPECT_EQ(r.cam_from_submap.translation, alone.cam_from_submap.translation);
  EXPECT_EQ(r.inliers, alone.inliers);
  // From the same place there is no epipolar line. A small error of the pose makes one, but it means nothing.
  const auto same_place = epipolar_view(scene, truth, truth, 200, 0.7, 0);
  const PoseResult still = optimize_pose(test_camera(), truth, observations, {}, {same_place});
  EXPECT_LT(rotation_error_deg(still.cam_from_submap, truth), 0.15);
  EXPECT_LT((still.cam_from_submap.center() - truth.center()).norm(), 0.02);
}

TEST(OptimizePose, WrongEpipolarMatchesAloneDoNoHarm) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SyntheticScene scene(seed);
    const SE3 truth = SyntheticScene::pose(0.2, -0.1, 0.1, 0.1, 0.05);
    const auto observations = observe(scene, truth, 60, 0.7, 0);
    const PoseResult r =
        optimize_pose(test_camera(), truth, observations, {}, {epipolar_view(scene, SE3(), truth, 200, 0.7, 1.0)});
    ASSERT_TRUE(r.converged);
    EXPECT_LT(rotation_error_deg(r.cam_from_submap, truth), 0.3);
  }
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
