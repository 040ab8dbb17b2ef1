// SPDX-License-Identifier: BSD-3-Clause
// Calibrates from recordings and writes calibration files.
#include <gmock/gmock.h>

#include <filesystem>
#include <opencv2/imgcodecs.hpp>

#include "bus/transport/log_file.h"
#include "bus/wire/image_codec.h"
#include "formats/camera/camera_file.h"
#include "rumi/calibration/capture.h"
#include "rumi/calibration/report.h"
#include "tests/rumi/calibration/board_scene.h"
#include "tests/support/temporary_folder.h"

namespace rumi::tool {
namespace {

using ::testing::AllOf;
using testing::BoardScene;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::TemporaryFolder;

constexpr int kImages = 24;

class CalibrationTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    const BoardScene scene(Board(), testing::pinhole_camera(480, 360));
    for (const testing::BoardPose& pose : scene.varied_poses(kImages, 45))
      images_.push_back(scene.render(pose, {}, static_cast<int>(images_.size())));
  }
  static void TearDownTestSuite() { images_.clear(); }

  void write_images(int count) const {
    for (int i = 0; i < count; ++i) cv::imwrite(folder_ / fmt::format("view{}.png", i), images_[i]);
  }
  std::string collect(ViewCollector* collector, int every = 1) const {
    return collect_from_recording(
               folder_.path().string(), "CAMERA", every, [] { return true; }, collector)
        .error_text();
  }
  static Result<Calibration> calibrate_from(const ViewCollector& collector) {
    return calibrate(collector.board(), collector.taken(), collector.spare(), collector.image_size(),
                     Camera::Model::kPinhole, {});
  }

  static std::vector<cv::Mat> images_;
  const TemporaryFolder folder_;
  ViewCollector collector_{Board(), {}};
};
std::vector<cv::Mat> CalibrationTest::images_;

TEST_F(CalibrationTest, OfAFolderIsAFileThatTheOthersRead) {
  write_images(kImages);
  ASSERT_EQ(collect(&collector_), "");
  EXPECT_EQ(collector_.counts().images, kImages);
  const Result<Calibration> calibration = calibrate_from(collector_);
  ASSERT_EQ(calibration.error_text(), "");
  const std::string yaml = calibration_to_yaml(*calibration, collector_);
  const Result<CameraFile> read = parse_camera(yaml, "camera.yaml");
  ASSERT_EQ(read.error_text(), "");
  EXPECT_EQ(read->format, "rumi");
  EXPECT_EQ(std::tie(read->camera.fx, read->camera.cy, read->camera.k1, read->camera.p2),
            std::tie(calibration->camera.fx, calibration->camera.cy, calibration->camera.k1, calibration->camera.p2));
  EXPECT_EQ(std::tie(read->camera.width, read->camera.height), std::make_tuple(480, 360));
  EXPECT_NEAR(read->camera.fx, 0.82 * 480, 2);
  EXPECT_THAT(yaml,
              AllOf(HasSubstr("board charuco:9x7:26:19:4X4_50"),
                    HasSubstr(fmt::format("reprojection error: {:.3f} px RMS, {} views", calibration->rms_px,
                                          calibration->views)),
                    HasSubstr("standard deviations: fx "), HasSubstr("at unknown times"), Not(HasSubstr("DOUBT"))));
  EXPECT_THAT(describe(*calibration), AllOf(HasSubstr("fx "), HasSubstr("reprojection error: ")));
  // Collecting and calibrating again gives the same file, to the bit.
  ViewCollector again(Board(), {});
  ASSERT_EQ(collect(&again), "");
  EXPECT_EQ(calibration_to_yaml(*calibrate_from(again), again), yaml);
}

TEST_F(CalibrationTest, OfALogTellsWhenItWasTaken) {
  const std::string file = folder_ / "camera.lcm";
  LogWriter log(file);
  int64_t utime_us = 1'700'000'000'000'000;  // 2023-11-14 22:13:20 UTC
  for (const cv::Mat& image : images_) {
    utime_us += 1'000'000;
    log.write(utime_us, "LEFT", encode_message(make_grey_image(utime_us, image)));
  }
  ASSERT_TRUE(log.close());
  ASSERT_EQ(collect_from_recording(
                file, "LEFT", 1, [] { return true; }, &collector_)
                .error_text(),
            "");
  const Result<Calibration> calibration = calibrate_from(collector_);
  ASSERT_EQ(calibration.error_text(), "");
  EXPECT_THAT(calibration_to_yaml(*calibration, collector_), HasSubstr("images taken 2023-11-14 22:13:2"));
  EXPECT_THAT(collect_from_recording(
                  file, "RIGHT", 1, [] { return true; }, &collector_)
                  .error_text(),
              HasSubstr("no image on channel 'RIGHT'"));
}

TEST_F(CalibrationTest, LooksAtEveryNthImageAndStopsWhenTold) {
  write_images(9);
  ASSERT_EQ(collect(&collector_, 3), "");
  EXPECT_EQ(collector_.counts().images, 3);
  ViewCollector stopped(Board(), {});
  EXPECT_EQ(collect_from_recording(
                folder_.path().string(), "CAMERA", 1, [] { return false; }, &stopped)
                .error_text(),
            "");
  EXPECT_EQ(stopped.counts().images, 1);
}

TEST_F(CalibrationTest, ADoubtfulOneSaysSoInTheFile) {
  write_images(kImages);
  ASSERT_EQ(collect(&collector_), "");
  Calibration calibration = calibrate_from(collector_).value();
  calibration.doubts = {"something"};
  const std::string yaml = calibration_to_yaml(calibration, collector_);
  EXPECT_THAT(yaml, HasSubstr("# DOUBTFUL: something\n"));
  EXPECT_TRUE(parse_camera(yaml, "camera.yaml").has_value());
}

TEST_F(CalibrationTest, NoImagesAtAll) {
  EXPECT_THAT(collect(&collector_), HasSubstr("no images"));
  EXPECT_THAT(collect_from_recording(
                  folder_ / "none", "CAMERA", 1, [] { return true; }, &collector_)
                  .error_text(),
              HasSubstr("no such file or folder"));
  EXPECT_THAT(collect_from_recording(
                  "/dev/video7", "CAMERA", 1, [] { return true; }, &collector_)
                  .error_text(),
              HasSubstr("is a camera: start `rumi camera_driver '/dev/video7'`"));
}

TEST_F(CalibrationTest, NoBoardInAnyImage) {
  for (int i = 0; i < 3; ++i)
    cv::imwrite(folder_ / fmt::format("{}.png", i), cv::Mat(360, 480, CV_8U, cv::Scalar(60 * i)));
  ASSERT_EQ(collect(&collector_), "");
  EXPECT_THAT(why_no_views(collector_, "folder"),
              HasSubstr("the board charuco:9x7:26:19:4X4_50 was not found in any of 3 images"));
}

TEST_F(CalibrationTest, AnotherBoard) {
  write_images(6);
  ViewCollector collector(parse_board("charuco:7x9:26:19").value(), {});
  ASSERT_EQ(collect(&collector), "");
  EXPECT_THAT(why_no_views(collector, "folder"),
              HasSubstr("of 6 images show markers of the dictionary, but not where"));
  ViewCollector chessboard(parse_board("chessboard:13x9:26").value(), {});
  ASSERT_EQ(collect(&chessboard), "");
  EXPECT_THAT(why_no_views(chessboard, "folder"), HasSubstr("columns and rows count squares, not corners"));
}

TEST_F(CalibrationTest, TheSameImageOverAndOver) {
  for (int i = 0; i < 10; ++i) cv::imwrite(folder_ / fmt::format("{}.png", i), images_[1]);
  ASSERT_EQ(collect(&collector_), "");
  EXPECT_EQ(collector_.counts().to_string(), "10 images: 1 views taken, 9 like these");
  EXPECT_THAT(calibrate_from(collector_).error_text(), HasSubstr("1 different views of the board are too few"));
}

TEST_F(CalibrationTest, ImagesThatAreCutOff) {
  write_images(4);
  for (int i = 0; i < 4; ++i) {
    const std::string file = folder_ / fmt::format("view{}.png", i);
    if (i != 1) std::filesystem::resize_file(file, 40);
  }
  ASSERT_EQ(collect(&collector_), "");
  EXPECT_EQ(collector_.counts().unreadable, 3);
  EXPECT_EQ(collector_.counts().taken, 1);
  EXPECT_THAT(collector_.first_unreadable(), HasSubstr("view0.png"));
  std::filesystem::remove(folder_ / "view1.png");
  ViewCollector none(Board(), {});
  ASSERT_EQ(collect(&none), "");
  EXPECT_THAT(why_no_views(none, "folder"), AllOf(HasSubstr("none of 3 images could be read"), HasSubstr("view0.png")));
}

TEST_F(CalibrationTest, ImagesOfDifferentSizes) {
  write_images(3);
  cv::imwrite(folder_ / "view3.png", images_[3].rowRange(0, 200));
  EXPECT_THAT(collect(&collector_), AllOf(HasSubstr("view3.png"), HasSubstr("is 480 x 200 pixels"),
                                          HasSubstr("the images before it are 480 x 360")));
}

}  // namespace
}  // namespace rumi::tool
