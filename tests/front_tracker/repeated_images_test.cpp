// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/repeated_images.h"

#include <gmock/gmock.h>

#include <opencv2/core.hpp>

#include "tests/support/captured_log.h"

namespace rumi::front_tracker {
namespace {

using ::testing::HasSubstr;
using Kind = RepeatedImages::Kind;

constexpr int64_t kBegin_us = 5'000'000, kPeriod_us = 100'000;

// Returns random pixels, different ones for each `which`.
cv::Mat image(int which) {
  cv::Mat grey(48, 64, CV_8U);
  cv::RNG rng(static_cast<uint64_t>(which + 1));
  rng.fill(grey, cv::RNG::UNIFORM, 20, 230);
  return grey;
}

class RepeatedImagesTest : public ::testing::Test {
 protected:
  Kind take(const cv::Mat& grey) { return images_.take(kBegin_us + kPeriod_us * taken_++, grey); }
  // Takes the image so many times. Returns the kind of the last one.
  Kind take(int which, int times) {
    Kind kind = Kind::kNew;
    for (int i = 0; i < times; ++i) kind = take(image(which));
    return kind;
  }

  testing::CapturedLog log_;
  RepeatedImages images_;
  int64_t taken_ = 0;
};

TEST_F(RepeatedImagesTest, OthersAreNew) {
  for (int i = 0; i < 5; ++i) EXPECT_EQ(take(i, 1), Kind::kNew);
  EXPECT_EQ(take(0, 1), Kind::kNew) << "it is that of some time before, not the last one";
  EXPECT_EQ(images_.doubled(), 0);
  EXPECT_EQ(images_.still(), 0);
  EXPECT_EQ(images_.text(), "");
  EXPECT_EQ(log_.text(), "");
}

TEST_F(RepeatedImagesTest, OneOrTwoAreDoubledAndFurtherOnesStandStill) {
  EXPECT_EQ(take(image(0)), Kind::kNew);
  EXPECT_EQ(take(image(0)), Kind::kDoubled);
  EXPECT_EQ(take(image(0)), Kind::kDoubled);
  EXPECT_EQ(images_.text(), "") << "no row yet";
  EXPECT_EQ(take(image(0)), Kind::kStill);
  EXPECT_EQ(take(image(0)), Kind::kStill);
  EXPECT_EQ(take(image(1)), Kind::kNew);
  EXPECT_EQ(take(image(1)), Kind::kDoubled) << "a row of its own";
  EXPECT_EQ(images_.doubled(), 3);
  EXPECT_EQ(images_.still(), 2);
}

TEST_F(RepeatedImagesTest, TellsTheLongestRowAndWhenItBegan) {
  take(0, 1 + 4);
  take(1, 1 + 6);  // the first is at 0.5 s
  take(2, 1 + 3);
  EXPECT_EQ(images_.longest().images, 6);
  EXPECT_NEAR(images_.longest().begin_s, 0.6, 1e-9);
  EXPECT_EQ(images_.text(), "7 images are the same as the one before; the longest row: 6 from 0.60 s on");
}

TEST_F(RepeatedImagesTest, EncodingOnceMoreLeavesItTheSame) {
  const cv::Mat grey = image(0);
  cv::Mat noisy = grey.clone(), other = grey.clone();
  for (int y = 0; y < grey.rows; ++y)
    for (int x = 0; x < grey.cols; ++x)
      noisy.at<uchar>(y, x) = static_cast<uchar>(grey.at<uchar>(y, x) + (x + y) % 3 - 1);
  other.at<uchar>(10, 10) += 2;
  take(grey);
  EXPECT_EQ(take(noisy), Kind::kDoubled);
  EXPECT_EQ(take(other), Kind::kNew);
}

// Each image hardly differs from the one before, but soon differs from the first of the row.
TEST_F(RepeatedImagesTest, WhatGetsBrighterIsNotTheSameForEver) {
  int fresh = 0;
  for (int i = 0; i < 20; ++i) fresh += take(cv::Mat(48, 64, CV_8U, cv::Scalar(100 + i))) == Kind::kNew;
  EXPECT_EQ(fresh, 10);
  EXPECT_EQ(images_.still(), 0);
}

TEST_F(RepeatedImagesTest, AnotherSizeIsNew) {
  take(cv::Mat(48, 64, CV_8U, cv::Scalar(9)));
  EXPECT_EQ(take(cv::Mat(64, 48, CV_8U, cv::Scalar(9))), Kind::kNew);
}

TEST_F(RepeatedImagesTest, TheCallersImageMayBeOverwritten) {
  cv::Mat grey = image(0);
  take(grey);
  image(1).copyTo(grey);
  EXPECT_EQ(take(grey), Kind::kNew);
}

TEST_F(RepeatedImagesTest, InASessionTimesAndRowsBeginAnew) {
  take(0, 1 + 4);
  images_.begin_session();
  EXPECT_EQ(take(0, 1), Kind::kNew) << "nothing is known of the last session's image";
  take(0, 5);
  EXPECT_EQ(images_.longest().images, 5);
  EXPECT_NEAR(images_.longest().begin_s, 0.1, 1e-9) << "since the session's first";
  EXPECT_EQ(images_.still(), 2 + 3) << "counts go on";
}

TEST_F(RepeatedImagesTest, TheFirstOneAndLongRowsAreSaid) {
  take(0, 1 + 9);
  EXPECT_THAT(log_.text(), HasSubstr("the image at 0.10 s is the same as the one before it"));
  const std::string before = log_.text();
  take(0, 1);
  const std::string row = log_.text().substr(before.size());
  EXPECT_THAT(row, HasSubstr("10 images in a row, from 0.10 s on"));
  take(0, 5);
  EXPECT_EQ(log_.text(), before + row) << "once";
  take(1, 1);
  EXPECT_THAT(log_.text(), HasSubstr("15 images in a row were the same"));
  const std::string after = log_.text();
  take(1, 3);
  EXPECT_EQ(log_.text(), after) << "a short row";
}

}  // namespace
}  // namespace rumi::front_tracker
