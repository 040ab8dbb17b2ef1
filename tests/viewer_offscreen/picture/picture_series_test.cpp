// SPDX-License-Identifier: BSD-3-Clause
#include "viewer_offscreen/picture/picture_series.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.h"

namespace rumi::viewer_offscreen {
namespace {

namespace fs = std::filesystem;

class PictureSeriesTest : public ::testing::Test {
 protected:
  static cv::Mat picture(int shade) { return {72, 128, CV_8UC3, cv::Scalar::all(shade)}; }
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_ / "pictures")) names.push_back(entry.path().filename());
    std::sort(names.begin(), names.end());
    return names;
  }
  const testing::TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path();
};

TEST_F(PictureSeriesTest, IsNumberedAndAVideo) {
  PictureSeries series(folder_, 5, true);
  for (int i = 0; i < 7; ++i) ASSERT_EQ(series.add(picture(20 + 30 * i)).error_text(), "");
  series.finish();
  EXPECT_EQ(series.size(), 7);
  for (int i = 0; i < 7; ++i) {
    const cv::Mat read = cv::imread((folder_ / "pictures" / ("00000" + std::to_string(i + 1) + ".png")).string());
    ASSERT_EQ(read.size(), cv::Size(128, 72));
    EXPECT_EQ(read.at<cv::Vec3b>(9, 9)[1], 20 + 30 * i);
  }
  cv::VideoCapture video((folder_ / "trajectory.mp4").string());
  EXPECT_NEAR(video.get(cv::CAP_PROP_FPS), 5, 1e-6);
  cv::Mat frame;
  int frames = 0;
  for (; video.read(frame); ++frames) EXPECT_NEAR(frame.at<cv::Vec3b>(36, 64)[1], 20 + 30 * frames, 8);
  EXPECT_EQ(frames, 7);
}

TEST_F(PictureSeriesTest, ANewSeriesReplacesAnEndedOneAndNothingElse) {
  {
    PictureSeries series(folder_, 5, true);
    for (int i = 0; i < 3; ++i) ASSERT_EQ(series.add(picture(9)).error_text(), "");
    series.finish();
  }
  std::ofstream(folder_ / "pictures" / "mine.png") << "x";
  PictureSeries series(folder_, 5, true);
  ASSERT_EQ(series.add(picture(9)).error_text(), "");
  series.finish();
  EXPECT_EQ(files(), (std::vector<std::string>{"000001.png", "mine.png"}));
}

TEST_F(PictureSeriesTest, GoesOnWithOneThatWasNotEnded) {
  for (int process = 0; process < 3; ++process) {  // none of them ends the series
    PictureSeries series(folder_, 5, true);
    for (int i = 0; i < 2; ++i) ASSERT_EQ(series.add(picture(30 * process + i)).error_text(), "");
    EXPECT_EQ(series.size(), 2 * process + 2);
  }
  EXPECT_EQ(files(), (std::vector<std::string>{"000001.png", "000002.png", "000003.png", "000004.png", "000005.png",
                                               "000006.png", "unfinished"}));
  EXPECT_EQ(cv::imread(folder_ / "pictures" / "000001.png").at<cv::Vec3b>(9, 9)[1], 0);
  EXPECT_EQ(cv::imread(folder_ / "pictures" / "000006.png").at<cv::Vec3b>(9, 9)[1], 61);
  PictureSeries series(folder_, 5, true);
  series.finish();  // it has not begun, so it ends nothing
  EXPECT_TRUE(fs::exists(folder_ / "pictures" / "unfinished"));
}

TEST_F(PictureSeriesTest, GoesOnOnlyWhereItIsTo) {
  ASSERT_EQ(PictureSeries(folder_, 5, true).add(picture(9)).error_text(), "");
  PictureSeries series(folder_, 5, false);
  ASSERT_EQ(series.add(picture(9)).error_text(), "");
  series.finish();
  EXPECT_EQ(files(), std::vector<std::string>{"000001.png"});
}

TEST_F(PictureSeriesTest, SaysWhatCannotBeWritten) {
  PictureSeries lost((folder_ / "missing").string(), 5, true);
  EXPECT_THAT(lost.add(picture(9)).error_text(), ::testing::HasSubstr("missing/pictures"));
  fs::create_directory(folder_ / "missing");
  EXPECT_EQ(lost.add(picture(9)).error_text(), "");  // the folder is there now
  std::ofstream(folder_ / "pictures") << "a file";
  EXPECT_THAT(PictureSeries(folder_, 5, true).add(picture(9)).error_text(), ::testing::HasSubstr("pictures"));
}

TEST_F(PictureSeriesTest, WithoutAVideoThereAreStillThePictures) {
  fs::create_directory(folder_ / "trajectory.mp4");  // a folder with the name of the video
  PictureSeries series(folder_, 5, true);
  EXPECT_THAT(series.add(picture(9)).error_text(), ::testing::HasSubstr("trajectory.mp4"));
  EXPECT_TRUE(fs::exists(folder_ / "pictures" / "000001.png"));
}

}  // namespace
}  // namespace rumi::viewer_offscreen
