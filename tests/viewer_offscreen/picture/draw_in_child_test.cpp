// SPDX-License-Identifier: BSD-3-Clause
#include "viewer_offscreen/picture/draw_in_child.h"

#include <gmock/gmock.h>
#include <signal.h>
#include <unistd.h>

#include <opencv2/core.hpp>
#include <stdexcept>

namespace rumi::viewer_offscreen {
namespace {

using ::testing::HasSubstr;

const cv::Size kSize(8, 5);

TEST(DrawInChild, ReturnsThePictureAndNothingElseChanges) {
  int drawn = 0;
  const Result<cv::Mat> picture = draw_in_child(kSize, [&drawn] {
    ++drawn;
    return cv::Mat(kSize, CV_8UC3, cv::Scalar(1, 2, 3));
  });
  ASSERT_TRUE(picture) << picture.error_text();
  EXPECT_EQ(picture->at<cv::Vec3b>(4, 7), cv::Vec3b(1, 2, 3));
  EXPECT_EQ(drawn, 0) << "it was drawn in another process";
}

TEST(DrawInChild, AFailureIsAnErrorThatSaysWhy) {
  const auto text = [](auto draw) { return draw_in_child(kSize, draw).error_text(); };
  EXPECT_EQ(text([]() -> cv::Mat { throw std::runtime_error("no OpenGL here"); }), "no OpenGL here");
  EXPECT_THAT(text([] { return cv::Mat(3, 4, CV_8UC3); }), HasSubstr("4 x 3 pixels"));
  EXPECT_THAT(text([] {
                raise(SIGKILL);
                return cv::Mat();
              }),
              HasSubstr("signal 9"));
}

TEST(DrawInChild, OneThatHangsIsEnded) {
  const auto hang = [] {
    for (;;) pause();
    return cv::Mat();
  };
  EXPECT_THAT(draw_in_child(kSize, hang, 0.05).error_text(), HasSubstr("took longer"));
}

}  // namespace
}  // namespace rumi::viewer_offscreen
