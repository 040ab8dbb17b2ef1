// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/build/window_prospects.h"

#include <gmock/gmock.h>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "bus/wire/image_codec.h"

namespace rumi::ruminator {
namespace {

using ::testing::HasSubstr;

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

TEST(WindowProspects, UsefulIsWhatPlacesTheGapOrBridgesIt) {
  EXPECT_TRUE(is_useful(0, 1, 0));
  EXPECT_TRUE(is_useful(3, 0, 3));
  EXPECT_FALSE(is_useful(10, 0, 2));
  EXPECT_FALSE(is_useful(0, 0, 0));
}

}  // namespace
}  // namespace rumi::ruminator
