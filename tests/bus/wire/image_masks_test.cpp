// SPDX-License-Identifier: BSD-3-Clause
#include "bus/wire/image_masks.h"

#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "bus/wire/image_codec.h"
#include "bus/wire/mask_file.h"
#include "tests/support/temporary_folder.h"

namespace rumi {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

// Returns a white picture with a black rectangle.
cv::Mat drawn(int width = 64, int height = 48) {
  cv::Mat pixels(height, width, CV_8U, cv::Scalar(255));
  cv::rectangle(pixels, {10, 20, 16, 12}, cv::Scalar(0), cv::FILLED);
  return pixels;
}

std::string png_of(const cv::Mat& pixels) {
  std::vector<uchar> bytes;
  cv::imencode(".png", pixels, bytes);
  return {bytes.begin(), bytes.end()};
}

bool are_same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

cv::Mat decoded(const std::string& bytes) { return decode_mask(bytes).value(); }

image_t image_with(const std::string& mask, int width = 64, int height = 48) {
  image_t image = make_grey_image(1, cv::Mat(height, width, CV_8U, cv::Scalar(9)));
  if (!mask.empty()) set_metadata(&image, kMaskKey, mask);
  return image;
}

TEST(ImageMasks, ComeBackAsTheyWereSent) {
  const std::string bytes = encode_mask(drawn());
  EXPECT_LT(bytes.size(), 200U) << "one bit a pixel";
  EXPECT_EQ(size_of_mask(bytes), cv::Size(64, 48));
  EXPECT_TRUE(are_same(decoded(bytes), drawn()));
  EXPECT_TRUE(are_same(decoded(encode_mask(drawn() / 255)), drawn())) << "1 is the world, too";
}

TEST(ImageMasks, OnlyBlackIsLeftOutWhateverTheFileHas) {
  cv::Mat colour(48, 64, CV_8UC3, cv::Scalar(0, 0, 1));  // nearly black, which grey would round to 0
  colour.setTo(cv::Scalar::all(0), drawn() == 0);
  EXPECT_TRUE(are_same(decoded(png_of(colour)), drawn()));
  cv::Mat opaque(48, 64, CV_8UC4, cv::Scalar(9, 9, 9, 0));  // fully transparent, which does not matter
  opaque.setTo(cv::Scalar(0, 0, 0, 255), drawn() == 0);
  EXPECT_TRUE(are_same(decoded(png_of(opaque)), drawn()));
  cv::Mat deep(48, 64, CV_16U, cv::Scalar(1));
  deep.setTo(0, drawn() == 0);
  EXPECT_TRUE(are_same(decoded(png_of(deep)), drawn()));
}

TEST(ImageMasks, BrokenBytesAreRefused) {
  const std::string good = encode_mask(drawn());
  std::vector<uchar> jpeg;
  cv::imencode(".jpg", drawn(), jpeg);
  for (const std::string& bytes :
       {std::string(), std::string("x"), std::string(100, '\0'), std::string(jpeg.begin(), jpeg.end()),
        good.substr(0, 20), good.substr(0, kMaskHeaderBytes), good.substr(0, 45)}) {
    EXPECT_THAT(decode_mask(bytes).error_text(), HasSubstr("no PNG that can be read")) << bytes.size();
  }
}

// The sizes in the header would take gigabytes.
TEST(ImageMasks, ASmallFileOfManyPixelsIsRefusedBeforeItIsDecoded) {
  std::string bytes = encode_mask(drawn());
  bytes[17] = 1;  // 65536 + 64 wide
  bytes[21] = 1;
  EXPECT_THAT(decode_mask(bytes).error_text(), HasSubstr("too large (65600 x 65584"));
  bytes[16] = '\x7F';
  EXPECT_TRUE(size_of_mask(bytes).empty()) << "no side is so long";
}

TEST(MaskReader, FitsTheMaskToTheSizeThatIsWorkedOn) {
  MaskReader reader;
  const ImageMask& mask = reader.read(image_with(encode_mask(drawn())), {32, 24});
  EXPECT_EQ(reader.problem(), "");
  EXPECT_EQ(mask.pixels().size(), cv::Size(32, 24));
  EXPECT_FALSE(mask.allows({8, 13}));
  EXPECT_TRUE(mask.allows({25, 13}));
  EXPECT_TRUE(reader.read(image_with(""), {32, 24}).is_everything());
}

TEST(MaskReader, AMaskThatCannotBeUsedIsEverythingAndIsTold) {
  MaskReader reader;
  EXPECT_TRUE(reader.read(image_with("no PNG"), {64, 48}).is_everything());
  EXPECT_THAT(reader.problem(), HasSubstr("no PNG"));
  EXPECT_TRUE(reader.read(image_with(encode_mask(drawn(60, 48))), {64, 48}).is_everything());
  EXPECT_THAT(reader.problem(), AllOf(HasSubstr("60 x 48"), HasSubstr("64 x 48")));
  reader.read(image_with(encode_mask(drawn())), {64, 48});
  EXPECT_EQ(reader.problem(), "") << "the next one is good";
}

TEST(MaskReader, WhatIsAlwaysLeftOutIsSoWithAndWithoutAMaskOfTheImage) {
  cv::Mat always(8, 10, CV_8U, cv::Scalar(255));
  always.at<uchar>(0, 0) = 0;
  MaskReader reader{ImageMask(always)};
  image_t image{};
  image.width = 10, image.height = 8;
  EXPECT_EQ(cv::countNonZero(reader.read(image, {10, 8}).pixels() == 0), 1);
  EXPECT_EQ(reader.read(image, {20, 16}).pixels().size(), cv::Size(20, 16));
  EXPECT_FALSE(reader.read(image, {20, 16}).allows({1, 1}));
  EXPECT_EQ(reader.problem(), "");
}

TEST(MaskReader, DecodesTheMaskOfImagesInARowOnce) {
  MaskReader reader;
  const image_t image = image_with(encode_mask(drawn()));
  const uchar* const pixels = reader.read(image, {64, 48}).pixels().data;
  EXPECT_EQ(reader.read(image, {64, 48}).pixels().data, pixels);
  EXPECT_NE(reader.read(image, {32, 24}).pixels().size(), cv::Size(64, 48));
  EXPECT_TRUE(reader.read(image_with("x"), {64, 48}).is_everything());
  EXPECT_FALSE(reader.read(image, {64, 48}).is_everything());
}

TEST(MaskFile, IsRefusedWithItsNameAndWhatToDo) {
  const testing::TemporaryFolder folder;
  const cv::Size size(64, 48);
  const auto error_of = [&](const std::string& name) { return read_camera_mask(folder / name, size).error_text(); };
  cv::imwrite(folder / "good.png", drawn());
  cv::imwrite(folder / "small.png", drawn(32, 24));
  cv::imwrite(folder / "black.png", cv::Mat(size, CV_8U, cv::Scalar(0)));
  cv::imwrite(folder / "a.jpg", drawn());
  testing::write_file(folder / "cut.png", encode_mask(drawn()).substr(0, 45));
  EXPECT_NEAR(share_left_out(read_camera_mask(folder / "good.png", size).value()), 16. * 12 / (64 * 48), 1e-9);
  EXPECT_THAT(error_of("small.png"), AllOf(HasSubstr("small.png: the mask is 32 x 24"), HasSubstr("are 64 x 48")));
  EXPECT_THAT(error_of("black.png"), HasSubstr("black.png: is black all over"));
  EXPECT_TRUE(read_mask_file(folder / "black.png", size).has_value()) << "of one image it may be";
  EXPECT_THAT(error_of("a.jpg"), HasSubstr("a.jpg: is not a PNG; give a PNG of the images' size"));
  EXPECT_THAT(error_of("cut.png"), HasSubstr("cut.png: the mask is no PNG that can be read"));
  EXPECT_THAT(error_of("none.png"), HasSubstr("none.png: no such file or folder; give a PNG"));
  EXPECT_THAT(error_of("."), HasSubstr("is not a file"));
  EXPECT_TRUE(check_mask_file(folder / "cut.png", size)) << "its beginning is all right";
}

}  // namespace
}  // namespace rumi
