// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/rebuild/window_prospects.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "bus/wire/image_codec.h"

namespace rumi::ruminator {
namespace {

using ::testing::HasSubstr;

const std::atomic<bool> kNoCancel = false;

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

TEST(WindowProspects, ABlindGapIsToldAtOnce) {
  EXPECT_THAT(find_blind_gap(job_of(40, cv::Mat::zeros(240, 320, CV_8U)), {}), HasSubstr("nothing to be seen"));
  EXPECT_EQ(find_blind_gap(job_of(40, picture(2, 1)), {}), "");
  EXPECT_EQ(find_blind_gap(job_of(40, picture(2, 0.15)), {}), "") << "dark is not blind";
}

TEST(WindowProspects, AShortGapIsNotLookedAt) {
  EXPECT_EQ(find_blind_gap(job_of(4, cv::Mat::zeros(240, 320, CV_8U)), {}), "");
  EXPECT_EQ(find_blind_gap(job_of(0, picture(2, 1)), {}), "");
}

// Points of a room, each seen by all images, and all pairs of images matched; the camera turns by 2 degrees from image
// to image and moves by the step.
struct Film {
  Camera camera;
  std::vector<SiftFeatures> images;
  std::vector<ImagePair> pairs;
};

Film film(int images, double step) {
  Film film;
  film.camera.width = 640, film.camera.height = 480;
  film.camera.fx = film.camera.fy = 500, film.camera.cx = 320, film.camera.cy = 240;
  cv::RNG random(9);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 200; ++i)
    points.emplace_back(random.uniform(-2.0, 2.0), random.uniform(-1.5, 1.5), random.uniform(3.0, 7.0));
  for (int k = 0; k < images; ++k) {
    const Eigen::AngleAxisd turn(k * 2 * M_PI / 180, Eigen::Vector3d::UnitY());
    SiftFeatures& seen = film.images.emplace_back();
    for (const Eigen::Vector3d& point : points) {
      const Eigen::Vector3d p = turn * (point - Eigen::Vector3d(k * step, 0, 0));
      seen.undistorted.emplace_back(static_cast<float>(500 * p.x() / p.z() + 320 + random.gaussian(0.5)),
                                    static_cast<float>(500 * p.y() / p.z() + 240 + random.gaussian(0.5)));
    }
    for (int other = 0; other < k; ++other) {
      ImagePair& pair = film.pairs.emplace_back(ImagePair{other, k, {}});
      for (int i = 0; i < 200; ++i) pair.matches.emplace_back(i, i);
    }
  }
  return film;
}

TEST(WindowProspects, WhatIsPublishedHasAProofOfItsDepth) {
  const Film turning = film(6, 0), moving = film(6, 0.1);
  EXPECT_THAT(find_no_depth(turning.camera, turning.images, turning.pairs, {0, 1, 2, 3, 4, 5}, kNoCancel),
              HasSubstr("0 show depth"));
  EXPECT_EQ(find_no_depth(moving.camera, moving.images, moving.pairs, {0, 1, 2, 3, 4, 5}, kNoCancel), "");
  EXPECT_NE(find_no_depth(moving.camera, moving.images, moving.pairs, {0, 5}, kNoCancel), "")
      << "two images are no model";
  EXPECT_NE(find_no_depth(moving.camera, moving.images, {}, {0, 1, 2}, kNoCancel), "");
  EXPECT_EQ(find_no_depth(turning.camera, turning.images, turning.pairs, {0, 1, 2, 3}, true), "") << "called off";
}

TEST(WindowProspects, UsefulIsWhatPlacesTheGapOrBridgesIt) {
  EXPECT_TRUE(is_useful(0, 1, 0));
  EXPECT_TRUE(is_useful(3, 0, 3));
  EXPECT_FALSE(is_useful(10, 0, 2));
  EXPECT_FALSE(is_useful(0, 0, 0));
}

}  // namespace
}  // namespace rumi::ruminator
