// SPDX-License-Identifier: BSD-3-Clause
#include "slam/geometry/epipolar.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "tests/slam/synthetic_scene.h"

namespace rumi {
namespace {

// Returns the distance of the undistorted pixel from the line, in pixels.
double distance_px(const Eigen::Vector3d& line, const Eigen::Vector2d& pixel) {
  return std::abs(line.dot(pixel.homogeneous())) / line.head<2>().norm();
}

TEST(Epipolar, EitherViewOfAPointLiesOnTheLineOfTheOther) {
  SyntheticScene scene(1);
  const Camera camera = test_camera();  // fx and fy differ, and the principal point is not the origin
  const SE3 b_from_a = SyntheticScene::pose(0.4, -0.1, 0.2, 0.1, -0.05);
  const Eigen::Matrix3d f = fundamental_matrix(camera, b_from_a);
  EXPECT_LT(std::abs(f.determinant()), 1e-12 * std::pow(f.norm(), 3));
  double farthest = 0;
  for (const Eigen::Vector3d& point_a : scene.cloud(100)) {
    const Eigen::Vector2d a = camera.project_undistorted(point_a);
    const Eigen::Vector2d b = camera.project_undistorted(b_from_a * point_a);
    EXPECT_LT(distance_px(f * a.homogeneous(), b), 1e-9);
    EXPECT_LT(distance_px(f.transpose() * b.homogeneous(), a), 1e-9);
    farthest = std::max(farthest, distance_px(f * b.homogeneous(), a));
  }
  EXPECT_GT(farthest, 10) << "a and b are not to be confused";
}

TEST(Epipolar, TheLinesOfAllPixelsMeetWhereTheOtherCameraIsSeen) {
  const Camera camera = test_camera();
  const SE3 b_from_a = SyntheticScene::pose(0.1, 0.2, -1.5, 0.02, 0.03);  // camera a is in front of camera b
  ASSERT_GT(b_from_a.translation.z(), 0);
  const Eigen::Vector2d a_seen_by_b = camera.project_undistorted(b_from_a.translation);
  const Eigen::Matrix3d f = fundamental_matrix(camera, b_from_a);
  for (const Eigen::Vector2d& pixel : {Eigen::Vector2d(0, 0), Eigen::Vector2d(639, 0), Eigen::Vector2d(100, 400)})
    EXPECT_LT(distance_px(f * pixel.homogeneous(), a_seen_by_b), 1e-9);
}

TEST(Epipolar, WithoutATranslationThereAreNoLines) {
  EXPECT_TRUE(fundamental_matrix(test_camera(), SyntheticScene::pose(0, 0, 0, 0.3, 0.1)).isZero(0));
}

TEST(Epipolar, SampsonsDistanceIsThatOfAPixelMovedOffTheLine) {
  SyntheticScene scene(2);
  const SE3 b_from_a = SyntheticScene::pose(0.4, -0.1, 0.2, 0.1, -0.05);
  const Eigen::Matrix3d e = essential_matrix(b_from_a);
  for (const Eigen::Vector3d& point_a : scene.cloud(50)) {
    const Eigen::Vector3d a = point_a / point_a.z(), point_b = b_from_a * point_a, b = point_b / point_b.z();
    EXPECT_LT(sampson_distance(e, a, b), 1e-12);
    const Eigen::Vector3d line = e * a;
    const Eigen::Vector2d off = 1e-4 * line.head<2>().normalized();
    const double distance = sampson_distance(e, a, b + Eigen::Vector3d(off.x(), off.y(), 0));
    // Sampson's distance is, to first order, the least correction of both views together: a share of the distance of b
    // from its line.
    const double share =
        line.head<2>().norm() / std::hypot(line.head<2>().norm(), (e.transpose() * b).head<2>().norm());
    EXPECT_NEAR(distance, 1e-4 * share, 1e-6);
  }
  EXPECT_TRUE(std::isinf(sampson_distance(Eigen::Matrix3d::Zero(), {0, 0, 1}, {0.1, 0, 1})));
}

}  // namespace
}  // namespace rumi
