// SPDX-License-Identifier: BSD-3-Clause
// Tests which images of a recording are left out, which recordings are refused, and what the user is told.
#include <gmock/gmock.h>

#include "bus/transport/bus.h"
#include "bus/transport/log_file.h"
#include "bus/wire/image_codec.h"
#include "tests/camera_driver/opened_source.h"

namespace rumi::camera_driver {
namespace {

using namespace testing;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(ImageSource, BadFramesAreLeftOutAndCounted) {
  const TemporaryFolder folder;
  write_tum(folder.path(), 10, ".jpg");
  write_file(folder / "rgb/2.jpg", read_file(folder / "rgb/2.jpg").substr(0, 500));
  write_file(folder / "rgb/3.jpg", "");
  fs::remove(folder / "rgb/4.jpg");
  write_file(folder / "rgb/5.jpg", std::string(1000, 'x'));
  cv::imwrite(folder / "rgb/6.jpg", picture(6, 32, 48));
  write_file(folder / "rgb.txt",
             read_file(folder / "rgb.txt") + "1000.9 rgb/8.jpg\n50.85 rgb/8.jpg\nabc rgb/9.jpg\n1001.5\n");
  const OpenedSource opened = open_image_source(folder.path().string(), {});
  ASSERT_EQ(opened.error_text(), "");
  EXPECT_THAT(times(**opened), ElementsAre(1000000000, 1000100000, 1000700000, 1000800000, 1000900000));
  const SkippedFrames& skipped = (*opened)->skipped();
  EXPECT_EQ(skipped.unreadable, 4);
  EXPECT_EQ(skipped.wrong_size, 1);
  EXPECT_EQ(skipped.duplicate, 1);
  EXPECT_EQ(skipped.out_of_order, 1);
  EXPECT_EQ(skipped.malformed, 2);
  EXPECT_THAT(skipped.to_string(), HasSubstr("4 unreadable images"));
}

TEST(ImageSource, ColourAndDepthInOneFolder) {
  const TemporaryFolder folder;
  for (int i = 0; i < 5; ++i) {
    cv::imwrite(folder / fmt::format("frame-{:06}.color.png", i), picture(i));
    cv::imwrite(folder / fmt::format("frame-{:06}.depth.png", i), picture(50 + i));
  }
  write_file(folder / "calibration.yaml", kCalibration);
  EXPECT_EQ(times(folder.path()).size(), 5u);
  CameraOptions options;
  options.files = "*.depth.png";
  const OpenedSource opened = open_image_source(folder.path().string(), options);
  EXPECT_EQ(cv::norm(decode_grey(*(*opened)->next()).value(), picture(50), cv::NORM_INF), 0);
  options.files = "*.jpg";
  EXPECT_THAT(error_of(folder.path(), options), HasSubstr("fits no image"));
}

TEST(ImageSource, AFolderOfFoldersNamesThoseWithImages) {
  const TemporaryFolder folder;
  fs::create_directories(folder / "image_0");
  cv::imwrite(folder / "image_0/0.png", picture(1));
  write_file(folder / "calibration.yaml", kCalibration);
  EXPECT_THAT(error_of(folder.path()), AllOf(HasSubstr("no images"), HasSubstr("image_0")));
}

TEST(ImageSource, ALogWithoutImagesOnTheChannelNamesThoseThatHaveSome) {
  const TemporaryFolder folder;
  write_file(folder / "calibration.yaml", kCalibration);
  const std::vector<uint8_t> image = encode_message(make_grey_image(1'000'000, picture(0)));
  const std::vector<uint8_t> other(20, 7);
  LogWriter with_images(folder / "images.lcm"), without(folder / "none.lcm");
  for (int i = 0; i < 3; ++i) with_images.write(i, "CAMERA_LEFT", image);
  with_images.write(4, "CAMERA", other);
  with_images.write(5, "POSE", other);
  without.write(1, "POSE", other);
  ASSERT_TRUE(with_images.close() && without.close());
  EXPECT_THAT(error_of(folder / "images.lcm"),
              AllOf(HasSubstr("images.lcm: no image on channel 'CAMERA', but 1 other"), HasSubstr("CAMERA_LEFT (3)"),
                    HasSubstr("--set camera_driver.log_channel=CAMERA_LEFT")));
  EXPECT_THAT(error_of(folder / "none.lcm"),
              AllOf(HasSubstr("no channel of it has images"), HasSubstr("it has messages on POSE (1)")));
}

TEST(SkippedFrames, ComplainOfMoreThanOnePerCentWithARemedy) {
  SkippedFrames skipped;
  skipped.unreadable = 1;
  EXPECT_TRUE(skipped.complaints(99).empty());
  EXPECT_THAT(skipped.complaints(90),
              ElementsAre(AllOf(HasSubstr("1 of 91 images (1.1 %)"), HasSubstr("record them"))));
  skipped.wrong_size = 50;
  EXPECT_EQ(skipped.complaints(49).size(), 1u);
}

TEST(SkippedFrames, ComplainOfImagesThatRepeatTheOneBefore) {
  SkippedFrames skipped;
  skipped.repeated = 30;
  skipped.longest_row = 29;
  skipped.longest_row_s = 4.0 / 3;
  EXPECT_EQ(skipped.to_string(), "30 the same as the one before");
  EXPECT_THAT(skipped.complaints(60),
              ElementsAre("30 of 90 images are the same as the one before them (the longest row: 29 images from 1.33 s "
                          "on): the camera or the recorder stood still; they have no pose"));
  EXPECT_TRUE(skipped.complaints(2970).empty());
}

TEST(ImageSource, CorruptPng) {
  const TemporaryFolder folder;
  write_tum(folder.path(), 3);
  const std::string png = read_file(folder / "rgb/1.png");
  write_file(folder / "rgb/1.png", png.substr(0, png.size() / 2));
  EXPECT_THAT(times(folder.path()), ElementsAre(1000000000, 1000200000));
}

TEST(ImageSource, RefusesWhatCannotBeUsed) {
  const TemporaryFolder folder;
  write_file(folder / "empty_list/rgb.txt", "# nothing\n");
  write_file(folder / "no_file/rgb.txt", "1.0 rgb/0.png\n");
  write_file(folder / "binary/rgb.txt", std::string("\x00\x01\xff\n\x02", 5));
  write_file(folder / "empty.lcm", "");
  write_file(folder / "garbage.mp4", std::string(5000, 'g'));
  for (const char* name : {"empty_list", "no_file", "binary"})
    write_file(folder.path() / name / "calibration.yaml", kCalibration);
  EXPECT_THAT(error_of(folder / "missing"), AllOf(HasSubstr("missing"), HasSubstr("no such file or folder")));
  EXPECT_THAT(error_of(folder.path()), HasSubstr("no rgb.txt"));
  EXPECT_THAT(error_of(folder / "empty_list"), AllOf(HasSubstr("rgb.txt"), HasSubstr("names no image")));
  EXPECT_THAT(error_of(folder / "binary"), HasSubstr("rgb.txt:1: time is"));
  EXPECT_THAT(error_of(folder / "no_file"), AllOf(HasSubstr("0.png"), HasSubstr("no such file")));
  EXPECT_THAT(error_of(folder / "empty.lcm"), HasSubstr("is empty"));
  EXPECT_THAT(error_of(folder / "binary/rgb.txt"), HasSubstr("give the folder"));
  EXPECT_THAT(error_of(folder / "garbage.mp4"), HasSubstr("neither an lcm log, a ROS bag nor a video"));
  EXPECT_THAT(error_of("/dev/video99"), HasSubstr("there is no such camera"));
  EXPECT_THAT(error_of("/dev/null"), HasSubstr("is not a camera"));
}

TEST(ImageSource, RefusesACalibrationThatDoesNotFit) {
  const TemporaryFolder folder;
  write_tum(folder.path(), 2);
  CameraOptions options;
  options.camera_file = folder / "other.yaml";
  EXPECT_THAT(error_of(folder.path(), options), AllOf(HasSubstr("other.yaml"), HasSubstr("no such file")));
  write_file(options.camera_file, "fx: 50\nfy: 50\ncx: 32\ncy: 24\nwidth: 640\nheight: 480\n");
  EXPECT_THAT(error_of(folder.path(), options),
              AllOf(HasSubstr("64 x 48"), HasSubstr("640 x 480"), HasSubstr("--camera")));
  write_file(options.camera_file, "fx: nan\nfy: 50\ncx: 32\ncy: 24\nwidth: 64\nheight: 48\n");
  EXPECT_THAT(error_of(folder.path(), options), HasSubstr("fx is 'nan'"));
  fs::remove(folder / "calibration.yaml");
  EXPECT_THAT(error_of(folder.path()), AllOf(HasSubstr("no calibration"), HasSubstr("--camera FILE")));
}

TEST(ImageSource, NamesTheCameraOfTheFileThatFits) {
  const TemporaryFolder folder;
  write_tum(folder.path(), 2);
  const auto camera = [](int number, int width, int height) {
    return fmt::format("cam{}: {{camera_model: pinhole, intrinsics: [50, 51, 32, 24], resolution: [{}, {}]}}\n", number,
                       width, height);
  };
  CameraOptions options;
  options.camera_file = folder / "camchain.yaml";
  write_file(options.camera_file, camera(0, 80, 60) + camera(1, 64, 48));
  EXPECT_THAT(error_of(folder.path(), options), AllOf(HasSubstr("80 x 60"), HasSubstr("camchain.yaml:cam1")));
  options.camera_file += ":cam1";
  EXPECT_EQ(open_recording(folder.path().string(), options).error_text(), "");
}

TEST(ImageSource, TakesTheBlockOfTheImagesSize) {
  const TemporaryFolder folder;
  write_tum(folder.path(), 2);
  const auto block = [](int width, int height) {
    return fmt::format(
        " Intrinsic of \"Color\" / {0}x{1} / {{RGB8}}\n  Width: {0}\n  Height: {1}\n  PPX: 32\n  PPY: 24\n  Fx: 50\n  "
        "Fy: 51\n"
        "  Distortion: Brown Conrady\n  Coeffs: 0 0 0 0 0\n\n",
        width, height);
  };
  CameraOptions options;
  options.camera_file = folder / "d435.txt";
  write_file(options.camera_file, block(80, 60) + block(64, 48));
  const OpenedSource opened = open_recording(folder.path().string(), options);
  ASSERT_EQ(opened.error_text(), "");
  EXPECT_EQ((*opened)->camera().width, 64);
}

}  // namespace
}  // namespace rumi::camera_driver
