// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/rebuild/first_look.h"

#include <gmock/gmock.h>

#include <opencv2/imgproc.hpp>

#include "bus/wire/image_codec.h"
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

// Renders what a camera sees that turns to the right inside a large cylinder, painted with blobs of many sizes.
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

struct Look {
  std::string hopeless;
  int images = 0;  // images examined
};

Look look_at(const WindowJob& job, const std::atomic<bool>& cancel = kNoCancel) {
  WindowImages images(job, job.camera, kSiftKeypoints);
  return {look_at_motion(job.camera, images, cancel).error_text(), images.decoded()};
}

TEST(FirstLook, ACameraThatStandsStillIsToldByFewImages) {
  const Look look = look_at(turning(100, 0));
  EXPECT_THAT(look.hopeless, HasSubstr("stands still"));
  EXPECT_LE(look.images, 8);
}

TEST(FirstLook, ACameraThatTurns) { EXPECT_THAT(look_at(turning(100, 0.5)).hopeless, HasSubstr("only turns")); }

// Each image has a field of view of 56 degrees, and neighbours among eight images are 50 degrees apart.
TEST(FirstLook, MoreImagesAreLookedAtWhereNeighboursHaveTooLittleInCommon) {
  const Look look = look_at(turning(40, 9));
  EXPECT_THAT(look.hopeless, HasSubstr("only turns"));
  EXPECT_GT(look.images, 8);
}

TEST(FirstLook, WhatDoesNotHangTogetherIsNotJudged) {
  WindowJob job = turning(20, 0);
  for (size_t i = 10; i < 20; ++i) job.images[i] = make_grey_image(job.images[i].utime, far_away(90));
  EXPECT_EQ(look_at(job).hopeless, "");
  for (size_t i = 10; i < 20; ++i)
    job.images[i] = make_grey_image(job.images[i].utime, cv::Mat::zeros(240, 320, CV_8U));
  EXPECT_EQ(look_at(job).hopeless, "") << "dark";
  for (size_t i = 10; i < 20; ++i) job.images[i].data.clear();
  EXPECT_NO_THROW(look_at(job)) << "broken";
}

TEST(FirstLook, ACameraThatMovesIsTold) {
  const Look look = look_at(testing::rendered_window().job);
  EXPECT_EQ(look.hopeless, "");
  EXPECT_LE(look.images, 4) << "the first pairs that match show it";
}

// If the process is told to stop, it must not examine all images first.
TEST(FirstLook, EndsWhenItIsCalledOff) {
  const std::atomic<bool> cancel = true;
  const WindowJob job = turning(100, 0);
  const Look look = look_at(job, cancel);
  EXPECT_EQ(look.hopeless, "");
  EXPECT_LE(look.images, 2);
}

TEST(FirstLook, NothingIsSaidOfOneImageOrNone) {
  EXPECT_EQ(look_at(turning(1, 0)).hopeless, "");
  EXPECT_EQ(look_at(turning(0, 0)).hopeless, "");
}

cv::Mat picture(double blur_px, double brightness) {
  cv::Mat grey(240, 320, CV_8U);
  cv::RNG(3).fill(grey, cv::RNG::UNIFORM, 0, 255);
  cv::GaussianBlur(grey, grey, {}, blur_px);
  cv::normalize(grey, grey, 0, 255 * brightness, cv::NORM_MINMAX);
  return grey;
}

WindowJob job_of(int gap, const cv::Mat& image) {
  WindowJob job;
  job.camera.width = image.cols, job.camera.height = image.rows;
  job.camera.fx = job.camera.fy = 300, job.camera.cx = 160, job.camera.cy = 120;
  for (int i = 0; i < gap; ++i) {
    job.window.gap.push_back({.utime_us = 1'000'000 + i});
    job.images.push_back(make_grey_image(1'000'000 + i, image));
  }
  return job;
}

std::string gap_error(const WindowJob& job) {
  WindowImages images(job, job.camera, kSiftKeypoints);
  return look_at_gap(job, images).error_text();
}

TEST(FirstLook, ABlindGapIsToldAtOnce) {
  EXPECT_THAT(gap_error(job_of(40, cv::Mat::zeros(240, 320, CV_8U))), HasSubstr("nothing to be seen"));
  EXPECT_EQ(gap_error(job_of(40, picture(2, 1))), "");
  EXPECT_EQ(gap_error(job_of(40, picture(2, 0.15))), "") << "dark is not blind";
}

TEST(FirstLook, AShortGapIsNotLookedAt) {
  EXPECT_EQ(gap_error(job_of(4, cv::Mat::zeros(240, 320, CV_8U))), "");
  EXPECT_EQ(gap_error(job_of(0, picture(2, 1))), "");
}

}  // namespace
}  // namespace rumi::ruminator
