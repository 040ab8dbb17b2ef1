// SPDX-License-Identifier: BSD-3-Clause
#include "slam/geometry/two_view.h"

#include <gtest/gtest.h>

#include "slam/geometry/triangulation.h"
#include "tests/slam/synthetic_scene.h"

namespace rumi {
namespace {

struct Views {
  std::vector<Eigen::Vector2f> first, second;
};

Views observe(SyntheticScene& scene, const std::vector<Eigen::Vector3d>& points, const SE3& second_from_first,
              double noise_px, double outliers) {
  const Camera camera = test_camera();
  Views v;
  for (const Eigen::Vector3d& p : points) {
    Eigen::Vector2d b = camera.project_undistorted(second_from_first * p) + scene.noise(noise_px);
    if (scene.uniform(0, 1) < outliers) b = {scene.uniform(0, 640), scene.uniform(0, 480)};
    v.first.push_back((camera.project_undistorted(p) + scene.noise(noise_px)).cast<float>());
    v.second.push_back(b.cast<float>());
  }
  return v;
}

double direction_error_deg(const SE3& a, const SE3& b) {
  return std::acos(std::clamp(a.translation.normalized().dot(b.translation.normalized()), -1.0, 1.0)) * 180 / M_PI;
}

TEST(TwoView, RecoversPoseOfGeneralScene) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    SyntheticScene scene(seed);
    const SE3 truth = SyntheticScene::pose(0.4, 0.1, 0.05, 0.05, -0.03);
    const Views v = observe(scene, scene.cloud(300), truth, 0.5, 0.2);
    const TwoViewResult r = reconstruct_two_views(test_camera(), v.first, v.second, {});
    ASSERT_TRUE(r.ok()) << r.refusal;
    ASSERT_EQ(r.hypotheses.size(), 1u) << "a scene with depth leaves no choice";
    const TwoViewHypothesis& h = r.hypotheses.front();
    EXPECT_LT(rotation_error_deg(h.second_from_first, truth), 0.5);
    EXPECT_LT(direction_error_deg(h.second_from_first, truth), 5);
    EXPECT_GT(h.inliers, 200);
    EXPECT_LT(h.inliers, 265);  // most of the 60 outliers are found
  }
}

TEST(TwoView, TruePoseOfAPlaneIsAmongTheHypotheses) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    SyntheticScene scene(seed);
    const SE3 truth = SyntheticScene::pose(0.5, 0.2, 0.3, 0.08, -0.05);
    const Views v = observe(scene, scene.plane(300), truth, 0.5, 0.1);
    const TwoViewResult r = reconstruct_two_views(test_camera(), v.first, v.second, {});
    ASSERT_TRUE(r.ok()) << r.refusal;
    EXPECT_LE(r.hypotheses.size(), 3u);
    double best = 180;
    for (const TwoViewHypothesis& h : r.hypotheses)
      best = std::min(
          best, rotation_error_deg(h.second_from_first, truth) + 0.1 * direction_error_deg(h.second_from_first, truth));
    EXPECT_LT(best, 1.5);
  }
}

TEST(TwoView, RefusesPureRotation) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    SyntheticScene scene(seed);
    const SE3 turned = SyntheticScene::pose(0, 0, 0, 0.15, 0.05);
    const Views v = observe(scene, scene.cloud(300), turned, 0.5, 0.1);
    const TwoViewResult r = reconstruct_two_views(test_camera(), v.first, v.second, {});
    EXPECT_FALSE(r.ok());
  }
}

TEST(TwoView, RefusesLowParallax) {
  SyntheticScene scene(3);
  const Views v = observe(scene, scene.cloud(300), SyntheticScene::pose(0.02, 0, 0), 0.3, 0);
  const TwoViewResult r = reconstruct_two_views(test_camera(), v.first, v.second, {});
  EXPECT_NE(r.refusal.find("parallax"), std::string::npos) << r.refusal;
}

TEST(TwoView, RefusesNoiseAndTooFewMatches) {
  SyntheticScene scene(4);
  const Views noise = observe(scene, scene.cloud(300), SyntheticScene::pose(0.4, 0, 0), 0.5, 1.0);
  EXPECT_FALSE(reconstruct_two_views(test_camera(), noise.first, noise.second, {}).ok());
  const Views few = observe(scene, scene.cloud(20), SyntheticScene::pose(0.4, 0, 0), 0.5, 0);
  EXPECT_EQ(reconstruct_two_views(test_camera(), few.first, few.second, {}).refusal, "20 matches, 60 needed");
  EXPECT_FALSE(reconstruct_two_views(test_camera(), {}, {}, {}).ok());
}

TEST(Triangulate, FindsThePointAndRefusesParallelRays) {
  const SE3 a = SyntheticScene::pose(0, 0, 0), b = SyntheticScene::pose(1, 0, 0, -0.1);
  const Eigen::Vector3d truth(0.3, -0.2, 5);
  const Eigen::Vector3d qa = a * truth, qb = b * truth;
  const auto point = triangulate(a, qa / qa.z(), b, qb / qb.z());
  ASSERT_TRUE(point);
  EXPECT_LT((*point - truth).norm(), 1e-9);
  EXPECT_NEAR(parallax_rad({0, 0, 1}, {-1, 0, 0}, {1, 0, 0}), M_PI / 2, 1e-12);
  EXPECT_FALSE(triangulate(a, {0, 0, 1}, SyntheticScene::pose(1, 0, 0), {0, 0, 1}));
  // These rays meet behind the cameras.
  EXPECT_FALSE(triangulate(a, {-0.2, 0, 1}, SyntheticScene::pose(1, 0, 0), {0.2, 0, 1}));
}

}  // namespace
}  // namespace rumi
