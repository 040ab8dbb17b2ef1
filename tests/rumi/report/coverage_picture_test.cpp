// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/report/coverage_picture.h"

#include <gtest/gtest.h>

#include "bus/wire/image_codec.h"
#include "tests/rumi/calibration/board_scene.h"

namespace rumi::tool {
namespace {

using testing::BoardScene;

class CoveragePicture : public ::testing::Test {
 protected:
  void add(double x, double tilt_x) {
    const cv::Mat image =
        scene_.render(scene_.pose({x * camera_.width, 0.5 * camera_.height}, 40, tilt_x, 0, 0.1), {}, 1);
    EXPECT_TRUE(collector_.add(make_grey_image(++utime_us_, image), "an image"));
  }
  // Returns the number of blue pixels in a part of the picture. Corners and the circles of views are blue.
  static int blue(const cv::Mat& picture, const cv::Rect& part) {
    cv::Mat mask;
    cv::inRange(picture(part), cv::Scalar(150, 50, 0), cv::Scalar(210, 120, 60), mask);
    return cv::countNonZero(mask);
  }
  static int ink(const cv::Mat& picture, const cv::Rect& part) {
    cv::Mat mask;
    cv::inRange(picture(part), cv::Scalar::all(0), cv::Scalar::all(120), mask);
    return cv::countNonZero(mask);
  }
  Camera camera_ = testing::pinhole_camera(640, 480);
  BoardScene scene_{Board(), camera_};
  ViewCollector collector_{Board(), {}};
  int64_t utime_us_ = 0;
};

// The image is drawn with 640 x 480 pixels at (24, 64), the tilts with 420 x 420 pixels at (754, 64).
const cv::Rect kLeft(24, 64, 160, 480), kRight(344, 64, 320, 480), kTilts(754, 64, 420, 420);
const cv::Rect kTiltNotes(754, 512, 420, 50);
const cv::Rect kTurned(754, 64, 100, 420);

TEST_F(CoveragePicture, ShowsWhereTheBoardWas) {
  add(0.8, 0);
  ASSERT_EQ(collector_.counts().taken, 1);
  const cv::Mat picture = draw_coverage(collector_);
  EXPECT_EQ(blue(picture, kLeft), 0);
  EXPECT_GT(blue(picture, kRight), 10 * static_cast<int>(collector_.taken()[0].corners.size()));
  const cv::Vec3b empty = picture.at<cv::Vec3b>(64 + 480 - 40, 24 + 40), white(255, 255, 255);
  EXPECT_NE(empty, white) << "the middle of an empty cell is crossed out";
  for (const cv::Point2f& pixel : collector_.taken()[0].pixels) {
    const cv::Point at(24 + cvRound(pixel.x + 0.5), 64 + cvRound(pixel.y + 0.5));
    EXPECT_GT(blue(picture, cv::Rect(at - cv::Point(1, 1), cv::Size(3, 3))), 4) << at;
  }
}

TEST_F(CoveragePicture, ShowsHowItWasTurned) {
  add(0.5, 0);
  const cv::Mat before = draw_coverage(collector_);
  EXPECT_GT(ink(before, kTiltNotes), 200);
  EXPECT_GT(blue(before, kTilts), 20);
  EXPECT_EQ(blue(before, kTurned), 0);
  add(0.5, 0.7);
  add(0.5, -0.7);
  ASSERT_EQ(collector_.counts().taken, 3);
  const cv::Mat after = draw_coverage(collector_);
  EXPECT_GT(blue(after, kTurned), 20);
}

TEST_F(CoveragePicture, ItsWordsNeedNoColumns) {
  for (const std::string& line : collector_.coverage().figures())
    EXPECT_EQ(line.find("  "), std::string::npos) << line << ": not all letters are of one width";
}

TEST_F(CoveragePicture, WithoutABoardEverythingIsMissing) {
  const cv::Mat wall(1200, 300, CV_8U, cv::Scalar(90));  // in portrait format
  ASSERT_TRUE(collector_.add(make_grey_image(1, wall), "an image"));
  const cv::Mat picture = draw_coverage(collector_);
  EXPECT_EQ(blue(picture, cv::Rect(cv::Point(), picture.size())), 0);
}

}  // namespace
}  // namespace rumi::tool
