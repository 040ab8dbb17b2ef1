// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/window/image_motion.h"

#include <gmock/gmock.h>

#include <opencv2/imgproc.hpp>

#include "bus/wire/image_codec.h"
#include "bus/wire/jpeg_image.h"

namespace rumi::ruminator {
namespace {

// Draws circles of many sizes, so that the picture has small and large structure.
cv::Mat scene(uint64_t seed = 1) {
  cv::Mat world(1000, 1400, CV_8U, cv::Scalar(120));
  cv::RNG random(seed);
  for (int i = 0; i < 1500; ++i)
    cv::circle(world, {random.uniform(0, world.cols), random.uniform(0, world.rows)}, random.uniform(2, 40),
               cv::Scalar(random.uniform(20, 240)), -1, cv::LINE_AA);
  return world;
}

cv::Mat look(const cv::Mat& world, double x, double y, double turn_deg = 0) {
  cv::Mat view;
  cv::Mat transform = cv::getRotationMatrix2D({static_cast<float>(x) + 320, static_cast<float>(y) + 240}, turn_deg, 1);
  transform.at<double>(0, 2) -= x;
  transform.at<double>(1, 2) -= y;
  cv::warpAffine(world, view, transform, {640, 480});
  return view;
}

cv::Mat motion_blurred(const cv::Mat& view, int length) {
  cv::Mat blurred;
  cv::blur(view, blurred, {length, 1});
  return blurred;
}

class ImageMotionTest : public ::testing::Test {
 protected:
  ImageMeasure give(const cv::Mat& view, bool is_jpeg = true) {
    ++now_;
    return motion_.measure(is_jpeg ? make_jpeg_image(now_, view) : make_grey_image(now_, view));
  }
  ImageMotion motion_;
  int64_t now_ = 0;
  cv::Mat world_ = scene();
};

TEST_F(ImageMotionTest, MeasuresDisplacementInFullPixels) {
  EXPECT_FALSE(give(look(world_, 100, 100)).motion_px) << "the first";
  double x = 100, y = 100;
  for (const cv::Point2d step : {cv::Point2d(12, 0), {0, 30}, {-20, 15}, {3, 0}, {0, 0}, {70, 0}}) {
    x += step.x, y += step.y;
    const ImageMeasure measure = give(look(world_, x, y));
    ASSERT_TRUE(measure.motion_px) << step;
    EXPECT_NEAR(*measure.motion_px, std::hypot(step.x, step.y), 1.0) << step;
  }
}

TEST_F(ImageMotionTest, RawAndCompressedImagesAgree) {
  give(look(world_, 100, 100), false);
  EXPECT_NEAR(give(look(world_, 120, 100), false).motion_px.value_or(-1), 20, 1);
  EXPECT_NEAR(give(look(world_, 140, 100), true).motion_px.value_or(-1), 20, 1);
}

TEST_F(ImageMotionTest, SeesATurnAboutTheOpticalAxis) {
  give(look(world_, 300, 200));
  const ImageMeasure measure = give(look(world_, 300, 200, 4));
  EXPECT_GT(measure.motion_px.value_or(-1), 8);  // 4 degrees at about 200 px from the middle
  EXPECT_LT(measure.motion_px.value_or(-1), 25);
}

TEST_F(ImageMotionTest, FollowsABlurredPicture) {
  cv::Mat from, to;
  cv::GaussianBlur(look(world_, 100, 100), from, {}, 8);
  cv::GaussianBlur(look(world_, 125, 100), to, {}, 8);
  give(from);
  EXPECT_NEAR(give(to).motion_px.value_or(-1), 25, 3);
}

TEST_F(ImageMotionTest, WhatCannotBeFollowedIsUnknown) {
  const cv::Mat black(480, 640, CV_8U, cv::Scalar(0));
  give(look(world_, 100, 100));
  EXPECT_FALSE(give(black).motion_px);
  EXPECT_EQ(give(black).sharpness, 0);
  EXPECT_FALSE(give(black).motion_px);
  EXPECT_FALSE(give(look(world_, 100, 100)).motion_px);
  EXPECT_FALSE(give(look(scene(2), 100, 100)).motion_px) << "another scene";
  cv::Mat noise(480, 640, CV_8U);
  cv::RNG(3).fill(noise, cv::RNG::UNIFORM, 0, 255);
  EXPECT_FALSE(give(noise).motion_px);
}

TEST_F(ImageMotionTest, BrokenImagesAreLivedWith) {
  give(look(world_, 100, 100));
  image_t broken = make_jpeg_image(7, look(world_, 110, 100));
  broken.data.resize(broken.data.size() / 2);
  broken.size = static_cast<int32_t>(broken.data.size());
  EXPECT_FALSE(motion_.measure(broken).motion_px);
  image_t liar = make_grey_image(8, look(world_, 110, 100));
  liar.height = 16000;
  EXPECT_FALSE(motion_.measure(liar).motion_px);
  EXPECT_FALSE(motion_.measure(image_t{}).motion_px);
  EXPECT_NEAR(give(look(world_, 120, 100)).motion_px.value_or(-1), 20, 1) << "compared with the last good one";
  const cv::Mat small = cv::Mat(60, 80, CV_8U, cv::Scalar(9));
  EXPECT_FALSE(give(small).motion_px) << "another size";
  const cv::Mat pixel = cv::Mat(1, 1, CV_8U, cv::Scalar(9));
  give(pixel);
  EXPECT_FALSE(give(pixel).motion_px);
}

TEST_F(ImageMotionTest, StartsAnewAfterReset) {
  give(look(world_, 100, 100));
  motion_.reset();
  EXPECT_FALSE(give(look(world_, 110, 100)).motion_px);
}

TEST_F(ImageMotionTest, MotionBlurShowsInTheSharpness) {
  const cv::Mat view = look(world_, 100, 100);
  const double sharp = give(view).sharpness;
  EXPECT_LT(give(motion_blurred(view, 30)).sharpness, 0.5 * sharp);
  cv::Mat dark = view * 0.5;
  EXPECT_NEAR(give(dark).sharpness / sharp, 1, 0.2) << "exposure is not blur";
  EXPECT_NEAR(give(look(world_, 160, 150)).sharpness / sharp, 1, 0.3) << "nor is motion";
}

TEST_F(ImageMotionTest, IsRepeatable) {
  const cv::Mat a = look(world_, 100, 100), b = look(world_, 117, 104);
  give(a);
  const ImageMeasure first = give(b);
  motion_.reset();
  give(a);
  const ImageMeasure second = give(b);
  EXPECT_EQ(first.motion_px, second.motion_px);
  EXPECT_EQ(first.sharpness, second.sharpness);
}

}  // namespace
}  // namespace rumi::ruminator
