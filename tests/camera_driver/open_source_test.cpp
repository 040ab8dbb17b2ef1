// SPDX-License-Identifier: BSD-3-Clause
// Tests the kinds of recordings that are played.
#include "camera_driver/open_source.h"

#include <gmock/gmock.h>

#include <opencv2/videoio.hpp>

#include "bus/transport/bus.h"
#include "bus/transport/log_file.h"
#include "bus/wire/calibration.h"
#include "bus/wire/image_codec.h"
#include "bus/wire/image_stream.h"
#include "formats/camera/camera_file.h"
#include "tests/camera_driver/opened_source.h"

namespace rumi::camera_driver {
namespace {

using namespace testing;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(ImageSource, TumFolder) {
  const TemporaryFolder folder;
  write_tum(folder.path(), 3);
  write_file(folder / "sub/rgb.txt", "#comment\r\n\r\n5.5\t../rgb/0.png\r\n6.000001 ../rgb/1.png\r\n");
  write_file(folder / "sub/calibration.yaml", kCalibration);
  EXPECT_THAT(times(folder.path()), ElementsAre(1000000000, 1000100000, 1000200000));
  EXPECT_THAT(times(folder / "sub/"), ElementsAre(5500000, 6000001));
}

TEST(ImageSource, ImagesCarryTheCalibration) {
  const TemporaryFolder folder;
  write_tum(folder.path(), 1);
  const OpenedSource opened = open_image_source(folder.path().string(), {});
  const std::optional<image_t> image = (*opened)->next();
  EXPECT_EQ(metadata(*image, kCalibrationKey), camera_to_yaml((*opened)->camera()));
  EXPECT_EQ((*opened)->camera().fy, 51);
  EXPECT_EQ((*opened)->total(), 1);
}

TEST(ImageSource, ARecordingIsOneStreamWhereverItLiesAndWhicheverPartIsPlayed) {
  const TemporaryFolder folder;
  write_tum(folder / "a", 5);
  const int64_t stream = stream_of(folder / "a");
  EXPECT_NE(stream, kNoStream);
  fs::copy(folder / "a", folder / "b", fs::copy_options::recursive);
  EXPECT_EQ(stream_of(folder / "b"), stream);
  CameraOptions part;
  part.start_s = 0.2, part.every = 2;
  EXPECT_EQ(stream_of(folder / "a", part), stream);

  CameraOptions other_times;
  other_times.rate_hz = 5;
  EXPECT_NE(stream_of(folder / "a", other_times), stream);
  cv::imwrite(folder / "b/rgb/0.png", picture(99));
  EXPECT_NE(stream_of(folder / "b"), stream) << "the same times, and another first image";
  write_tum(folder / "c", 6);
  EXPECT_NE(stream_of(folder / "c"), stream) << "other times";
}

TEST(ImageSource, ALogKeepsTheStreamOfItsImages) {
  const TemporaryFolder folder;
  for (const bool is_named : {true, false}) {
    const std::string file = folder / fmt::format("{}.lcmlog", is_named);
    LogWriter log(file);
    for (int i = 0; i < 3; ++i) {
      image_t image = make_grey_image(1'000'000 * (i + 1), picture(i));
      if (is_named) set_stream(77, &image);
      log.write(image.utime, channels::kCamera, encode_message(image));
    }
    ASSERT_TRUE(log.close());
    write_file(folder / "calibration.yaml", kCalibration);
    if (is_named)
      EXPECT_EQ(stream_of(file), 77);
    else
      EXPECT_NE(stream_of(file), kNoStream);
  }
}

TEST(ImageSource, EurocFolderAtEveryDepth) {
  const TemporaryFolder folder;
  const fs::path cam0 = folder / "mav0/cam0";
  write_file(cam0 / "data.csv",
             "#timestamp [ns],filename\r\n1403636579763555584,a.png\r\n1403636579813555456,b.png\r\n");
  write_file(cam0 / "sensor.yaml",
             "rate_hz: 20\nresolution: [64, 48]\ncamera_model: pinhole\nintrinsics: [50, 51, 32, 24]\n"
             "distortion_model: radial-tangential\ndistortion_coefficients: [0.1, 0, 0, 0]\n");
  fs::create_directories(cam0 / "data");
  for (const char* name : {"a.png", "b.png"}) cv::imwrite((cam0 / "data" / name).string(), picture(1));
  for (const char* input : {"", "mav0", "mav0/cam0", "mav0/cam0/"})
    EXPECT_THAT(times(folder / input), ElementsAre(1403636579763556, 1403636579813555)) << input;
}

TEST(ImageSource, PlainFolder) {
  const TemporaryFolder folder;
  for (int i : {1, 2, 10}) cv::imwrite(folder / fmt::format("{}.png", i), picture(i));
  write_file(folder / "calibration.yaml", kCalibration);
  EXPECT_THAT(times(folder.path()), ElementsAre(0, 100000, 200000));  // at the fps of the calibration
  CameraOptions options;
  options.rate_hz = 30;
  EXPECT_THAT(times(folder.path(), options), ElementsAre(0, 33333, 66667));
  const OpenedSource opened = open_image_source(folder.path().string(), {});
  (*opened)->next();
  EXPECT_EQ(cv::norm(decode_grey(*(*opened)->next()).value(), picture(2), cv::NORM_INF), 0);
  write_file(folder / "calibration.yaml", "fx: 50\nfy: 51\ncx: 32\ncy: 24\nwidth: 64\nheight: 48\n");
  EXPECT_THAT(error_of(folder.path()), HasSubstr("--rate HZ"));
}

TEST(ImageSource, Video) {
  const TemporaryFolder folder;
  const fs::path file = folder / "v.avi";
  cv::VideoWriter writer(file.string(), cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 20, cv::Size(64, 48));
  if (!writer.isOpened()) GTEST_SKIP() << "this OpenCV cannot write a video";
  for (int i = 0; i < 5; ++i) writer.write(picture(i, 64, 48, true));
  writer.release();
  write_file(folder / "calibration.yaml", kCalibration);
  EXPECT_THAT(times(file), ElementsAre(0, 50000, 100000, 150000, 200000));
  CameraOptions options;
  options.loop = true;
  EXPECT_THAT(times(file, options, 7), ElementsAre(0, 50000, 100000, 150000, 200000, 250000, 300000));
}

TEST(ImageSource, Encodings) {
  const TemporaryFolder folder;
  write_tum(folder.path(), 1, ".jpg");
  const std::string bytes = read_file(folder / "rgb/0.jpg");
  const auto format = [&folder](const std::string& encoding) {
    CameraOptions options;
    options.encoding = encoding;
    return *open_image_source(folder.path().string(), options).value()->next();
  };
  for (const char* as_is : {"auto", "jpeg"}) {
    const image_t image = format(as_is);
    EXPECT_EQ(image.pixelformat, image_t::PIXEL_FORMAT_MJPEG);
    EXPECT_EQ(std::string(image.data.begin(), image.data.end()), bytes);
  }
  EXPECT_EQ(format("grey").pixelformat, image_t::PIXEL_FORMAT_GRAY);
  EXPECT_EQ(format("rgb").pixelformat, image_t::PIXEL_FORMAT_RGB);
  write_tum(folder.path(), 1, ".png");
  EXPECT_EQ(format("auto").pixelformat, image_t::PIXEL_FORMAT_GRAY);
  EXPECT_EQ(format("jpeg").pixelformat, image_t::PIXEL_FORMAT_MJPEG);
  EXPECT_EQ(format("rgb").pixelformat, image_t::PIXEL_FORMAT_RGB);
}

TEST(ImageSource, RealDatasetsOpen) {
  const char* variable = std::getenv("RUMI_DATA_DIR");
  const fs::path data = variable ? fs::path(variable) : fs::path(RUMI_SOURCE_DIR) / "../shared/data";
  if (!fs::exists(data / "redkitchen"))
    GTEST_SKIP() << "*** NOT TESTED: no real recordings in " << data << "; set RUMI_DATA_DIR to their folder";
  const std::pair<const char*, size_t> recordings[] = {{"redkitchen", 1000},
                                                       {"redkitchen_soft", 1000},
                                                       {"hololens", 373},
                                                       {"v1_03_rendered", 2092},
                                                       {"fr3_office_1hz", 17}};
  for (const auto& [name, count] : recordings) EXPECT_EQ(times(data / name, {}, 5000).size(), count) << name;
}

}  // namespace
}  // namespace rumi::camera_driver
