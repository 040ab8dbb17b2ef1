// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/masking/still_parts.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <opencv2/imgproc.hpp>

namespace rumi::front_tracker {
namespace {

constexpr int kWidth = 320, kHeight = 240, kFirstVerdict = 16;
constexpr int64_t kPeriod_us = 200'000;
const cv::Rect kBar(0, 200, kWidth, 40);

// Returns an image with blobs of a few pixels everywhere.
cv::Mat texture(const cv::Size& size, int seed) {
  cv::Mat image(size, CV_8U);
  cv::RNG rng(static_cast<uint64_t>(seed));
  rng.fill(image, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(image, image, {}, 2);
  cv::normalize(image, image, 0, 255, cv::NORM_MINMAX);
  return image;
}

// Returns the view of a camera that moves past a textured world, by a few pixels from one look to the next.
cv::Mat world(int look) {
  static const cv::Mat whole = texture({3 * kWidth, 3 * kHeight}, 1);
  const auto swing = [](int at, int range) { return std::abs(at % (2 * range) - range); };  // back and forth
  return whole({swing(7 * look, 2 * kWidth), swing(5 * look, 2 * kHeight), kWidth, kHeight}).clone();
}

// Returns world() with a textured bar at the bottom that never moves.
cv::Mat world_with_bar(int look) {
  static const cv::Mat bar = texture(kBar.size(), 2);
  cv::Mat image = world(look);
  bar.copyTo(image(kBar));
  return image;
}

double left_out(const ImageMask& mask, const cv::Rect& part) {
  if (mask.is_everything()) return 0;
  return 1 - static_cast<double>(cv::countNonZero(mask.pixels()(part))) / part.area();
}

const cv::Rect kAboveTheBar(0, 0, kWidth, 180);

class StillPartsTest : public ::testing::Test {
 protected:
  // Returns whether the mask changed.
  bool add(const cv::Mat& image, const ImageMask& known = {}) {
    return parts_.add(kPeriod_us * added_++, image, known);
  }
  void look_at_bar(int looks, const ImageMask& known = {}) {
    for (int i = 0; i < looks; ++i) add(world_with_bar(i), known);
  }

  StillParts parts_;
  int64_t added_ = 0;
};

TEST_F(StillPartsTest, ABarIsLeftOutAfterAFewLooksAndTheRestIsNot) {
  for (int i = 0; i + 1 < kFirstVerdict; ++i) ASSERT_FALSE(add(world_with_bar(i))) << i;
  EXPECT_TRUE(parts_.mask().is_everything());
  EXPECT_TRUE(add(world_with_bar(kFirstVerdict - 1)));
  EXPECT_EQ(parts_.looks(), kFirstVerdict);
  ASSERT_EQ(parts_.mask().pixels().size(), cv::Size(kWidth, kHeight));
  EXPECT_GT(left_out(parts_.mask(), kBar), 0.98);
  EXPECT_LT(left_out(parts_.mask(), kAboveTheBar), 0.01);
  for (int i = kFirstVerdict; i < 60; ++i) add(world_with_bar(i));
  EXPECT_GT(left_out(parts_.mask(), kBar), 0.98);
  EXPECT_LT(left_out(parts_.mask(), kAboveTheBar), 0.01);
}

TEST_F(StillPartsTest, AWorldWithoutABarIsAllWorld) {
  for (int i = 0; i < 60; ++i) EXPECT_FALSE(add(world(i))) << i;
  EXPECT_EQ(parts_.looks(), 60);
  EXPECT_TRUE(parts_.mask().is_everything());
}

TEST_F(StillPartsTest, ACameraThatStandsLearnsNothing) {
  cv::RNG rng(3);
  for (int i = 0; i < 40; ++i) {
    cv::Mat noise(kHeight, kWidth, CV_16S), image;
    rng.fill(noise, cv::RNG::NORMAL, 0, 1.5);
    cv::add(world(0), noise, image, cv::noArray(), CV_8U);
    EXPECT_FALSE(add(image));
  }
  EXPECT_EQ(parts_.looks(), 1);
  EXPECT_TRUE(parts_.mask().is_everything());
}

TEST_F(StillPartsTest, WhatWasLearntStaysWhileTheCameraStands) {
  look_at_bar(20);
  const uchar* learnt = parts_.mask().pixels().data;
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(add(world_with_bar(19)));
  EXPECT_EQ(parts_.looks(), 20);
  EXPECT_EQ(parts_.mask().pixels().data, learnt);
}

TEST_F(StillPartsTest, ImagesThatFollowTooSoonAreNotLookedAt) {
  for (int i = 0; i < 8; ++i) parts_.add(50'000 * i, world(i));
  EXPECT_EQ(parts_.looks(), 2);
}

TEST_F(StillPartsTest, WhatMovesAfterAllIsWithdrawn) {
  look_at_bar(30);
  ASSERT_GT(left_out(parts_.mask(), kBar), 0.98);
  bool changed = false;
  for (int i = 30; i < 80; ++i) changed = add(world(i)) || changed;
  EXPECT_TRUE(changed);
  EXPECT_TRUE(parts_.mask().is_everything()) << left_out(parts_.mask(), kBar);
}

// Only the contour of a bonnet is still; its paint mirrors what passes by.
TEST_F(StillPartsTest, WhatABonnetsContourEnclosesIsLeftOut) {
  cv::Mat bonnet = cv::Mat::zeros(kHeight, kWidth, CV_8U), contour = bonnet.clone();
  const cv::Point middle(kWidth / 2, kHeight);
  const cv::Size half(130, 90);
  cv::ellipse(bonnet, middle, half, 0, 180, 360, cv::Scalar(255), cv::FILLED);
  cv::ellipse(contour, middle, half, 0, 180, 360, cv::Scalar(255), 6);
  for (int i = 0; i < 30; ++i) {
    cv::Mat image = world(i);
    cv::Mat(world(i + 200) / 2).copyTo(image, bonnet);
    image.setTo(255, contour);
    add(image);
  }
  const cv::Mat& pixels = parts_.mask().pixels();
  ASSERT_FALSE(pixels.empty());
  EXPECT_EQ(cv::countNonZero(pixels & bonnet), 0);
  cv::Mat wide;
  cv::dilate(bonnet | contour, wide, cv::getStructuringElement(cv::MORPH_RECT, {33, 33}));
  const int beyond = cv::countNonZero(wide == 0);
  EXPECT_GT(cv::countNonZero(pixels & (wide == 0)), 0.97 * beyond) << "not much else is";
}

TEST_F(StillPartsTest, WhatTheUserLeavesOutIsNotLookedAt) {
  cv::Mat pixels(kHeight, kWidth, CV_8U, cv::Scalar(255));
  const cv::Rect left(0, 0, kWidth / 2, kHeight);
  pixels(left).setTo(0);
  look_at_bar(30, ImageMask(pixels));
  EXPECT_GT(left_out(parts_.mask(), kBar & cv::Rect(kWidth / 2, 0, kWidth / 2, kHeight)), 0.98);
  const cv::Rect left_without_bays(0, 0, kWidth / 2 - 2 * 24, kHeight);
  EXPECT_EQ(left_out(parts_.mask(), left_without_bays), 0) << "it is the user's";
}

TEST_F(StillPartsTest, ABarThatTheUserLeavesOutIsNotSaidAgain) {
  cv::Mat pixels(kHeight, kWidth, CV_8U, cv::Scalar(255));
  pixels(kBar).setTo(0);
  look_at_bar(30, ImageMask(pixels));
  EXPECT_EQ(left_out(parts_.mask(), kBar), 0);
  EXPECT_EQ(left_out(parts_.mask(), kAboveTheBar), 0);
  pixels.rowRange(190, 200).setTo(0);  // also leaves out rows that the bar's edge may touch
  parts_ = {};
  look_at_bar(30, ImageMask(pixels));
  EXPECT_TRUE(parts_.mask().is_everything());
}

}  // namespace
}  // namespace rumi::front_tracker
