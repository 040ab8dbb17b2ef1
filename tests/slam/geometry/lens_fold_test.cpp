// SPDX-License-Identifier: BSD-3-Clause
#include "slam/geometry/lens_fold.h"

#include <gtest/gtest.h>

#include <cmath>

#include "slam/features/lens_mask.h"

namespace rumi {
namespace {

Camera camera_with(double k1, double k2, double k3) {
  Camera camera;
  camera.width = 640, camera.height = 480;
  camera.fx = camera.fy = 380, camera.cx = 320, camera.cy = 240;
  camera.k1 = k1, camera.k2 = k2, camera.k3 = k3;
  return camera;
}

TEST(LensFold, ALensThatImagesAllFartherOutFoldsNowhere) {
  EXPECT_FALSE(std::isfinite(fold_radius(camera_with(0, 0, 0))));
  EXPECT_FALSE(std::isfinite(fold_radius(camera_with(-0.28, 0.074, 0.01))));
  EXPECT_TRUE(lens_mask(camera_with(0, 0, 0)).is_everything());
}

// The distorted radius r (1 - 0.3 r^2) is largest at r = sqrt(1 / 0.9).
TEST(LensFold, IsWhereTheRadiusStopsGrowing) {
  const double r = std::sqrt(1 / 0.9);
  EXPECT_NEAR(fold_radius(camera_with(-0.3, 0, 0)), r * (1 - 0.3 * r * r), 1e-3);
  Camera fisheye = camera_with(-0.3, 0, 0);
  fisheye.model = Camera::Model::kKannalaBrandt;
  EXPECT_FALSE(std::isfinite(fold_radius(fisheye))) << "beyond 60 degrees";
  fisheye.k1 = -0.6;
  EXPECT_TRUE(std::isfinite(fold_radius(fisheye)));
}

// The corners are 400 px from the centre, the middle of the right border 320 px.
TEST(LensMask, LeavesOutWhatLiesBeyondTheFold) {
  const Camera camera = camera_with(-0.45, 0, 0);
  const double radius_px = 380 * fold_radius(camera);
  ASSERT_GT(radius_px, 200);
  ASSERT_LT(radius_px, 320);
  const ImageMask mask = lens_mask(camera);
  ASSERT_EQ(mask.pixels().size(), cv::Size(640, 480));
  EXPECT_TRUE(mask.allows({320, 240}));
  EXPECT_TRUE(mask.allows({320 + static_cast<float>(radius_px) - 2, 240}));
  EXPECT_FALSE(mask.allows({320 + static_cast<float>(radius_px) + 2, 240}));
  EXPECT_FALSE(mask.allows({0, 0}));
}

// A pixel that is not left out can be undistorted: its ray is projected onto it again.
TEST(LensMask, WhatIsLeftCanBeUndistorted) {
  const Camera camera = camera_with(-0.3, 0.02, -0.03);
  const ImageMask mask = lens_mask(camera);
  ASSERT_FALSE(mask.is_everything());
  int asked = 0;
  for (int y = 0; y < camera.height; y += 8)
    for (int x = 0; x < camera.width; x += 8) {
      if (!mask.allows({static_cast<float>(x), static_cast<float>(y)}, 3)) continue;
      const auto again = camera.project(camera.unproject({x, y}));
      ASSERT_TRUE(again);
      EXPECT_LT((*again - Eigen::Vector2d(x, y)).norm(), 0.5) << x << ' ' << y;
      ++asked;
    }
  EXPECT_GT(asked, 1000);
}

}  // namespace
}  // namespace rumi
