// SPDX-License-Identifier: BSD-3-Clause
#include "slam/geometry/camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>

#include "tests/slam/synthetic_scene.h"

namespace rumi {
namespace {

Camera distorted() {
  Camera c = test_camera();
  c.k1 = -0.28;
  c.k2 = 0.074;
  c.p1 = 0.0002;
  c.p2 = -0.0003;
  c.k3 = 0.01;
  return c;
}

TEST(Camera, UnprojectInvertsProjectForEveryModel) {
  SyntheticScene scene(1);
  for (const Camera& camera : {test_camera(), distorted(), test_fisheye()}) {
    for (int i = 0; i < 200; ++i) {
      const Eigen::Vector3d ray(scene.uniform(-0.55, 0.55), scene.uniform(-0.42, 0.42), 1);
      const auto pixel = camera.project(3.7 * ray);
      ASSERT_TRUE(pixel);
      EXPECT_LT((camera.unproject(*pixel) - ray).norm(), 1e-8);
      EXPECT_LT((camera.undistort(*pixel) - camera.project_undistorted(ray)).norm(), 1e-5);
    }
  }
}

TEST(Camera, RayInvertsProjectUndistorted) {
  SyntheticScene scene(2);
  const Camera camera = distorted();  // its distortion must not matter here
  for (const Eigen::Vector3d& point : scene.cloud(100))
    EXPECT_LT((camera.ray(camera.project_undistorted(point)) - point / point.z()).norm(), 1e-12);
}

TEST(Camera, AgreesWithOpenCv) {
  const Eigen::Vector3d p(0.4, -0.3, 1.2);
  const std::vector<cv::Point3d> points{{p.x(), p.y(), p.z()}};
  std::vector<cv::Point2d> expected;
  const Camera c = distorted();
  const cv::Matx33d k(c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1);
  cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), k, std::vector<double>{c.k1, c.k2, c.p1, c.p2, c.k3}, expected);
  EXPECT_LT((*c.project(p) - Eigen::Vector2d(expected[0].x, expected[0].y)).norm(), 1e-9);

  const Camera f = test_fisheye();
  const cv::Matx33d kf(f.fx, 0, f.cx, 0, f.fy, f.cy, 0, 0, 1);
  cv::fisheye::projectPoints(points, expected, cv::Vec3d(), cv::Vec3d(), kf, cv::Vec4d(f.k1, f.k2, f.k3, f.k4));
  EXPECT_LT((*f.project(p) - Eigen::Vector2d(expected[0].x, expected[0].y)).norm(), 1e-9);
}

TEST(Camera, NothingIsSeenBehind) {
  EXPECT_FALSE(test_camera().project({0.1, 0.1, -1}));
  EXPECT_FALSE(test_camera().project({0.1, 0.1, 0}));
  EXPECT_FALSE(test_camera().project({0, 0, std::numeric_limits<double>::quiet_NaN()}));
}

TEST(Camera, ScalingKeepsRays) {
  const Camera full = distorted(), smaller = full.resized(full.width / 2, full.height / 3);
  const Eigen::Vector2d pixel(100, 380);
  // The centre of a half-size pixel lies between two full-size ones.
  const Eigen::Vector2d same((pixel.x() + 0.5) / 2 - 0.5, (pixel.y() + 0.5) / 3 - 0.5);
  EXPECT_LT((full.unproject(pixel) - smaller.unproject(same)).norm(), 1e-9);
}

// The distortion of these lenses cannot be inverted, but callers need finite pixels all the same.
TEST(Camera, AnImpossibleLensGivesNumbersAllTheSame) {
  for (const Camera::Model model : {Camera::Model::kPinhole, Camera::Model::kKannalaBrandt})
    for (const double k : {1e3, -1e3, 1e100, -1e300}) {
      Camera c = test_camera();
      c.model = model;
      c.k1 = k;
      c.k2 = -k / 3;
      for (const Eigen::Vector2d& pixel :
           {Eigen::Vector2d(0, 0), Eigen::Vector2d(c.width - 1, 7), Eigen::Vector2d(-1, -1)})
        EXPECT_LT(c.undistort(pixel).norm(), 1e9) << k;
    }
}

TEST(Camera, CheckNamesFieldAndValue) {
  EXPECT_EQ(test_camera().check(), "");
  Camera c = test_camera();
  c.fx = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(c.check().find("fx is nan"), std::string::npos) << c.check();
  c = test_camera();
  c.cx = 2000;
  EXPECT_NE(c.check().find("cx is 2000"), std::string::npos) << c.check();
  c = test_camera();
  c.width = 0;
  EXPECT_NE(c.check().find("width is 0"), std::string::npos) << c.check();
  c = {};
  c.width = 640, c.height = 480, c.cx = 320, c.cy = 240;
  c.fx = c.fy = 3.6;
  EXPECT_NE(c.check().find("fx is 3.6: must be in pixels"), std::string::npos) << c.check();
  c.fx = 525, c.fy = 52.5;
  EXPECT_NE(c.check().find("fy is 52.5"), std::string::npos) << c.check();
  c.fy = 525, c.cx = 0.5, c.cy = 0.5;
  EXPECT_NE(c.check().find("cx is 0.5: must be in pixels"), std::string::npos) << c.check();
  c.fx = 1e-300;
  EXPECT_NE(c.check().find("fx is 1e-300"), std::string::npos) << c.check();
  c = test_camera();
  c.fy = -1;
  EXPECT_NE(c.check().find("fy is -1"), std::string::npos) << c.check();
}

}  // namespace
}  // namespace rumi
