// SPDX-License-Identifier: BSD-3-Clause
#include "formats/image/library_messages.h"

#include <gtest/gtest.h>

#include <iostream>
#include <opencv2/videoio.hpp>

#include "camera_driver/open_source.h"
#include "tests/formats/recording.h"

namespace rumi::camera_driver {
namespace {

using namespace testing;

// Plays a recording to its end. Returns what was printed to stderr.
std::string printed_by(const std::string& input) {
  ::testing::internal::CaptureStderr();
  const OpenedSource opened = open_recording(input, {});
  while (opened.has_value() && (*opened)->next()) continue;
  std::fflush(stderr);
  return ::testing::internal::GetCapturedStderr();
}

TEST(LibraryMessages, OfBrokenImagesDoNotReachTheUser) {
  const TemporaryFolder folder;
  write_tum(folder.path(), 4);
  const std::string png = read_file(folder / "rgb/1.png");
  folder.write("rgb/1.png", png.substr(0, png.size() / 2));
  cv::imwrite(folder / "rgb/2.bmp", picture(2));
  const std::string bmp = read_file(folder / "rgb/2.bmp");
  folder.write("rgb/2.png", bmp.substr(0, bmp.size() / 2));
  const std::string printed = printed_by(folder.path().string());
  EXPECT_EQ(printed.find("libpng"), std::string::npos) << printed;
  EXPECT_EQ(printed.find("imdecode"), std::string::npos) << printed;
}

TEST(LibraryMessages, OfBrokenVideosDoNotReachTheUser) {
  const TemporaryFolder folder;
  write_file(folder / "calibration.yaml", kCalibration);
  const std::string file = folder / "v.avi";
  {
    cv::VideoWriter video(file, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 10, cv::Size(64, 48));
    for (int i = 0; i < 10; ++i) video.write(picture(i, 64, 48, true));
  }
  std::string bytes = read_file(file);
  for (size_t i = bytes.size() / 3; i < 2 * bytes.size() / 3; i += 50) bytes[i] = 0x55;
  folder.write("v.avi", bytes);
  ::testing::internal::CaptureStdout();  // a log that was not started goes there
  const std::string printed = printed_by(file);
  const std::string log = ::testing::internal::GetCapturedStdout();
  EXPECT_EQ(printed.find(" @ 0x"), std::string::npos) << printed;
  EXPECT_EQ(log.find("FFmpeg says"), log.rfind("FFmpeg says")) << "once";
}

TEST(LibraryMessages, OnlyWhileTheyAreAskedFor) {
  ::testing::internal::CaptureStderr();
  {
    const DecoderMessages are_ours;
    std::cerr << "unseen";
    std::fputs("unseen", stderr);
  }
  std::cerr << "seen";
  std::fputs(" again", stderr);
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "seen again");
}

}  // namespace
}  // namespace rumi::camera_driver
