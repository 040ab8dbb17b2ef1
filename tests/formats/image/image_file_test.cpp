// SPDX-License-Identifier: BSD-3-Clause
#include "formats/image/image_file.h"

#include <gmock/gmock.h>

#include "bus/wire/image_codec.h"
#include "camera_driver/open_source.h"
#include "camera_driver/options.h"
#include "tests/formats/recording.h"

namespace rumi::camera_driver {
namespace {

using namespace testing;
using namespace std::string_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

cv::Mat deep(const cv::Mat& grey, double scale, double offset) {
  cv::Mat out;
  grey.convertTo(out, CV_16U, scale, offset);
  return out;
}

cv::Mat grey_of(const std::optional<image_t>& image) { return image ? decode_grey(*image).value() : cv::Mat(); }

TEST(GreyRange, IsParsedStrictly) {
  EXPECT_EQ(parse_grey_range("0:4095")->high, 4095);
  EXPECT_EQ(parse_grey_range("7400:8400")->low, 7400);
  for (const char* bad : {"", "auto", "5", "5:", ":5", "5:5", "9:5", "-1:5", "0:65536", "0:5x", "0 : 5"})
    EXPECT_FALSE(parse_grey_range(bad)) << bad;
  CameraOptions options;
  options.grey_range = "5";
  EXPECT_THAT(check(options).error_text(), HasSubstr("grey_range is '5'"));
}

// Cameras for machine vision write 12 bits, thermal cameras a narrow range of 14.
TEST(GreyRange, OfARecordingIsThatOfItsImages) {
  for (const auto& [scale, offset] : {std::pair{16.0, 0.0}, std::pair{4.0, 7400.0}, std::pair{257.0, 0.0}}) {
    const TemporaryFolder folder;
    write_tum(folder.path(), 20);
    const cv::Mat dim = picture(3) / 2;
    for (int i = 0; i < 20; ++i)
      cv::imwrite(folder / fmt::format("rgb/{}.png", i), deep(i == 7 ? dim : picture(i), scale, offset));
    const OpenedSource opened = open_image_source(folder.path().string(), {});
    ASSERT_EQ(opened.error_text(), "");
    for (int i = 0; i < 20; ++i) {
      const cv::Mat expected = i == 7 ? dim : picture(i);
      EXPECT_LE(cv::norm(grey_of((*opened)->next()), expected, cv::NORM_INF), 3)
          << scale << ": image " << i << ", by one range for all";
    }
  }
}

TEST(GreyRange, OfTheOptionsWins) {
  const TemporaryFolder folder;
  write_tum(folder.path(), 3);
  for (int i = 0; i < 3; ++i) cv::imwrite(folder / fmt::format("rgb/{}.png", i), deep(picture(i), 1, 1000));
  CameraOptions options;
  options.grey_range = "1000:1510";
  const OpenedSource opened = open_image_source(folder.path().string(), options);
  EXPECT_LE(cv::norm(grey_of((*opened)->next()), picture(0) / 2, cv::NORM_INF), 1);
}

TEST(ImageFile, OtherDepthsAreRefusedByName) {
  const TemporaryFolder folder;
  cv::imwrite(folder / "float.tiff", cv::Mat(48, 64, CV_32F, cv::Scalar(0.5)));
  EXPECT_THAT(load_image_file(folder / "float.tiff", false, [] { return GreyRange(); }).error_text(),
              HasSubstr("neither of 8 nor of 16 bits"));
}

TEST(ImageFile, WhiteOfAPgmIsWhatItsHeaderSays) {
  const TemporaryFolder folder;
  for (const std::string& pgm :
       {"P5\n# 4 bits\n2 2\n15\n\x00\x05\x0A\x0F"s, "P2\n2 2\n15\n0 5 10 15\n"s, "P5\n2 2\n255\n\x00\x55\xAA\xFF"s}) {
    write_file(folder / "a.pgm", pgm);
    const auto image = load_image_file(folder / "a.pgm", false, [] { return GreyRange(); });
    ASSERT_TRUE(image) << image.error_text();
    EXPECT_THAT(image->data, ElementsAre(0, 85, 170, 255));
  }
}

TEST(ImageFile, BytesAfterTheEndOfAJpegAreNotOfTheImage) {
  const TemporaryFolder folder;
  cv::imwrite(folder / "a.jpg", picture(1));
  const std::string jpeg = read_file(folder / "a.jpg");
  for (const std::string& more : {std::string(5, '\0'), std::string("\r\n"), std::string(2000, 'x')}) {
    write_file(folder / "a.jpg", jpeg + more);
    const auto image = load_image_file(folder / "a.jpg", false, [] { return GreyRange(); });
    ASSERT_TRUE(image) << image.error_text();
    EXPECT_EQ(std::string(image->data.begin(), image->data.end()), jpeg);
    EXPECT_FALSE(grey_of(*image).empty());
  }
}

}  // namespace
}  // namespace rumi::camera_driver
