// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/rebuild/window_look.h"

#include <gmock/gmock.h>

#include <opencv2/core/eigen.hpp>
#include <opencv2/imgproc.hpp>

#include "bus/wire/image_codec.h"
#include "bus/wire/image_masks.h"
#include "slam/geometry/transform.h"
#include "tests/ruminator/rendered_window.h"

namespace rumi::ruminator {
namespace {

using ::testing::HasSubstr;

const std::atomic<bool> kNoCancel = false;

Camera camera_of() {
  Camera camera;
  camera.width = 320, camera.height = 240;
  camera.fx = camera.fy = 300, camera.cx = 160, camera.cy = 120;
  return camera;
}

// What a camera that turns to the right sees of pictures far away: blobs of many sizes, as a cylinder around it.
cv::Mat far_away(double turn_deg) {
  static const cv::Mat panorama = [] {
    cv::Mat all(700, 3000, CV_8U, cv::Scalar(128));
    cv::RNG random(7);
    for (int i = 0; i < 6000; ++i)
      cv::circle(all, {random.uniform(0, all.cols), random.uniform(0, all.rows)}, random.uniform(2, 12),
                 cv::Scalar(random.uniform(0, 256)), cv::FILLED, cv::LINE_AA);
    return all;
  }();
  const Camera camera = camera_of();
  cv::Mat x(camera.height, camera.width, CV_32F), y = x.clone(), seen;
  for (int row = 0; row < camera.height; ++row)
    for (int column = 0; column < camera.width; ++column) {
      const double a = (column - camera.cx) / camera.fx, b = (row - camera.cy) / camera.fy;
      x.at<float>(row, column) = static_cast<float>(camera.fx * (std::atan(a) + turn_deg * M_PI / 180) + 700);
      y.at<float>(row, column) = static_cast<float>(camera.fx * b / std::hypot(a, 1) + 350);
    }
  cv::remap(panorama, seen, x, y, cv::INTER_LINEAR);
  cv::Mat noise(seen.size(), CV_8U);
  cv::randn(noise, 10, 2);
  return seen + noise;
}

WindowJob turning(int images, double step_deg) {
  WindowJob job;
  job.camera = camera_of();
  for (int i = 0; i < images; ++i) {
    job.window.gap.push_back({.utime_us = 1'000'000 + i});
    job.images.push_back(make_grey_image(1'000'000 + i, far_away(i * step_deg)));
  }
  return job;
}

WindowLook look_at(const WindowJob& job) { return look_at_motion(job, job.camera, {}, kNoCancel); }

TEST(WindowLook, ACameraThatStandsStillIsToldByFewImages) {
  const WindowLook look = look_at(turning(100, 0));
  EXPECT_THAT(look.hopeless, HasSubstr("stands still"));
  EXPECT_LE(look.features.size(), 8U);
}

TEST(WindowLook, ACameraThatTurns) { EXPECT_THAT(look_at(turning(100, 0.5)).hopeless, HasSubstr("only turns")); }

TEST(WindowLook, WhatAMaskLeavesOutIsNotLookedAt) {
  WindowJob job = turning(100, 0);
  cv::Mat world(240, 320, CV_8U, cv::Scalar(255));
  world.colRange(0, 160) = 0;
  for (image_t& image : job.images) set_metadata(&image, kMaskKey, encode_mask(world));
  const WindowLook look = look_at(job);
  EXPECT_THAT(look.hopeless, HasSubstr("stands still"));
  ASSERT_FALSE(look.features.empty());
  for (const auto& [image, features] : look.features) {
    EXPECT_GT(features.size(), 50U);
    for (const Eigen::Vector2f& pixel : features.undistorted) ASSERT_GE(pixel.x(), 160) << image;
  }
}

// Neighbours among eight images are 50 degrees apart, of 56 that each sees.
TEST(WindowLook, MoreImagesAreLookedAtWhereNeighboursHaveTooLittleInCommon) {
  const WindowLook look = look_at(turning(40, 9));
  EXPECT_THAT(look.hopeless, HasSubstr("only turns"));
  EXPECT_GT(look.features.size(), 8U);
}

TEST(WindowLook, WhatDoesNotHangTogetherIsNotJudged) {
  WindowJob job = turning(20, 0);
  for (size_t i = 10; i < 20; ++i) job.images[i] = make_grey_image(job.images[i].utime, far_away(90));
  EXPECT_EQ(look_at(job).hopeless, "");
  for (size_t i = 10; i < 20; ++i)
    job.images[i] = make_grey_image(job.images[i].utime, cv::Mat::zeros(240, 320, CV_8U));
  EXPECT_EQ(look_at(job).hopeless, "") << "dark";
  for (size_t i = 10; i < 20; ++i) job.images[i].data.clear();
  EXPECT_NO_THROW(look_at(job)) << "broken";
}

TEST(WindowLook, ACameraThatMovesIsTold) {
  const WindowLook look =
      look_at_motion(testing::rendered_window().job, testing::rendered_window().job.camera, {}, kNoCancel);
  EXPECT_EQ(look.hopeless, "");
  EXPECT_LE(look.features.size(), 4U) << "the first pairs that match show it";
}

// A process that is told to stop does not look at everything first.
TEST(WindowLook, EndsWhenItIsCalledOff) {
  const std::atomic<bool> cancel = true;
  const WindowJob job = turning(100, 0);
  const WindowLook look = look_at_motion(job, job.camera, {}, cancel);
  EXPECT_EQ(look.hopeless, "");
  EXPECT_LE(look.features.size(), 1U);
}

TEST(WindowLook, NothingIsSaidOfOneImageOrNone) {
  EXPECT_EQ(look_at(turning(1, 0)).hopeless, "");
  EXPECT_EQ(look_at(turning(0, 0)).hopeless, "");
}

}  // namespace
}  // namespace rumi::ruminator
