// SPDX-License-Identifier: BSD-3-Clause
#include "formats/image/tiff_pages.h"

#include <gmock/gmock.h>

#include "bus/wire/image_codec.h"
#include "camera_driver/open_source.h"
#include "tests/formats/recording.h"

namespace rumi::camera_driver {
namespace {

using namespace testing;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class TiffPages : public ::testing::Test {
 protected:
  TiffPages() {
    at_rate_.rate_hz = 10;
    folder_.write("calibration.yaml", kCalibration);
  }
  void write(const std::string& name, const std::vector<cv::Mat>& pages) {
    ASSERT_TRUE(cv::imwritemulti(folder_ / name, pages));
  }
  static std::vector<cv::Mat> pictures(int count) {
    std::vector<cv::Mat> all;
    for (int i = 0; i < count; ++i) all.push_back(picture(i));
    return all;
  }
  std::vector<cv::Mat> play(const fs::path& input) {
    const OpenedSource opened = open_recording(input.string(), at_rate_);
    EXPECT_EQ(opened.error_text(), "");
    std::vector<cv::Mat> all;
    while (const std::optional<image_t> image = opened.has_value() ? (*opened)->next() : std::nullopt)
      all.push_back(decode_grey(*image).value());
    if (opened.has_value()) skipped_ = (*opened)->skipped();
    return all;
  }
  TemporaryFolder folder_;
  CameraOptions at_rate_;
  SkippedFrames skipped_;
};

TEST_F(TiffPages, OfOneFileAreItsImages) {
  write("stack.tif", pictures(12));
  for (const fs::path& input : {folder_.path(), folder_.path() / "stack.tif"}) {
    const std::vector<cv::Mat> images = play(input);
    ASSERT_EQ(images.size(), 12u) << input;
    for (int i = 0; i < 12; ++i) EXPECT_EQ(cv::norm(images[i], picture(i), cv::NORM_INF), 0) << i;
    EXPECT_EQ(skipped_.total(), 0);
  }
  EXPECT_THAT(open_frames(folder_.path(), {}).value()->notes(), Contains(HasSubstr("12 pages of 'stack.tif'")));
  CameraOptions without;
  folder_.write("calibration.yaml", "fx: 50\nfy: 51\ncx: 32\ncy: 24\nwidth: 64\nheight: 48\n");
  EXPECT_THAT(open_recording(folder_ / "stack.tif", without).error_text(),
              HasSubstr("the pages of a TIFF file have no times; give --rate HZ"));
}

TEST_F(TiffPages, Of16BitsHaveOneRange) {
  std::vector<cv::Mat> pages;
  for (int i = 0; i < 8; ++i) pages.emplace_back(48, 64, CV_16UC1, cv::Scalar(1000 + 100 * i));
  write("thermal.tiff", pages);
  const std::vector<cv::Mat> images = play(folder_ / "thermal.tiff");
  ASSERT_EQ(images.size(), 8u);
  for (int i = 0; i < 8; ++i) EXPECT_NEAR(images[i].at<uint8_t>(24, 32), 255.0 * i / 7, 1) << i;
}

TEST_F(TiffPages, BehindTheFirstOfSeveralFilesCountAsLeftOut) {
  for (int i = 0; i < 4; ++i) write(fmt::format("{}.tif", i), {picture(i), picture(i + 100), picture(i + 200)});
  const std::vector<cv::Mat> images = play(folder_.path());
  ASSERT_EQ(images.size(), 4u);
  EXPECT_EQ(cv::norm(images[3], picture(3), cv::NORM_INF), 0);
  EXPECT_EQ(skipped_.unreadable, 8);
  EXPECT_THAT(open_frames(folder_.path(), {}).value()->notes(),
              Contains(HasSubstr("4 of its TIFF files have several pages: the first page of each is played, 8")));
}

TEST_F(TiffPages, OfAnotherSizeAreNone) {
  write("thumbnail.tif", {picture(0), picture(0, 16, 12), picture(1)});
  EXPECT_THAT(pages_of_tiff(folder_ / "thumbnail.tif"), ElementsAre(0, 2));
  const std::vector<cv::Mat> images = play(folder_ / "thumbnail.tif");
  ASSERT_EQ(images.size(), 2u);
  EXPECT_EQ(cv::norm(images[1], picture(1), cv::NORM_INF), 0);
}

TEST_F(TiffPages, OfDamagedFilesEnd) {
  write("a.tif", pictures(3));
  const std::string whole = read_file(folder_ / "a.tif");
  for (size_t length = 0; length < whole.size(); length += 97)
    EXPECT_LE(pages_of_tiff(folder_.write("b.tif", whole.substr(0, length))).size(), 3u);
  EXPECT_THAT(pages_of_tiff(folder_.write("b.tif", "not a TIFF")), IsEmpty());
  EXPECT_THAT(pages_of_tiff(folder_ / "missing.tif"), IsEmpty());
  // A directory without entries that names itself as the next one.
  const std::string ring = std::string("II*\0\x08\0\0\0", 8) + std::string("\0\0\x08\0\0\0", 6);
  EXPECT_FALSE(pages_of_tiff(folder_.write("b.tif", ring)).empty());
}

}  // namespace
}  // namespace rumi::camera_driver
