// SPDX-License-Identifier: BSD-3-Clause
#include "bus/wire/image_codec.h"

#include <gmock/gmock.h>

#include <random>

#include "bus/transport/bus.h"
#include "bus/wire/jpeg_image.h"
#include "tests/formats/recording.h"

namespace rumi::camera_driver {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::picture;

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

std::string error_of(const image_t& image) {
  const Result<cv::Mat> decoded = decode_grey(image);
  EXPECT_FALSE(decoded);
  return decoded.error_text();
}

TEST(ImageCodec, RoundTrips) {
  EXPECT_TRUE(same(decode_grey(make_grey_image(5, picture(1))).value(), picture(1)));
  const cv::Mat colour = picture(2, 64, 48, true);
  EXPECT_TRUE(same(decode_bgr(make_rgb_image(5, colour)).value(), colour));
  // A part of a larger picture, whose rows do not follow each other in memory.
  const cv::Mat part = picture(3)(cv::Rect(5, 7, 31, 20));
  EXPECT_TRUE(same(decode_grey(make_grey_image(5, part)).value(), part));
  EXPECT_EQ(make_rgb_image(5, colour).data[0], colour.at<cv::Vec3b>(0, 0)[2]);
}

TEST(ImageCodec, JpegDecodesAsOpenCvDoes) {
  const image_t jpeg = make_jpeg_image(7, picture(1, 65, 47, true), 90);
  EXPECT_TRUE(same(decode_grey(jpeg).value(), cv::imdecode(jpeg.data, cv::IMREAD_GRAYSCALE)));
  EXPECT_TRUE(same(decode_bgr(jpeg).value(), cv::imdecode(jpeg.data, cv::IMREAD_COLOR)));
  EXPECT_EQ(jpeg.utime, 7);
  EXPECT_EQ(jpeg.row_stride, 0);
}

TEST(ImageCodec, YuyvAndPaddedRows) {
  image_t image = make_grey_image(0, cv::Mat(2, 2, CV_8UC1, cv::Scalar(0)));
  image.pixelformat = image_t::PIXEL_FORMAT_YUYV;
  image.row_stride = 6;
  image.data = {10, 128, 20, 128, 0, 0, 30, 128, 40, 128};  // the last row without its padding
  image.size = 10;
  const cv::Mat grey = decode_grey(image).value();
  EXPECT_EQ(grey.at<uint8_t>(1, 1), 40);
  EXPECT_EQ(grey.at<uint8_t>(0, 1), 20);
}

TEST(ImageCodec, HostileHeadersAreRefused) {
  const image_t good = make_grey_image(0, picture(1));
  const auto with = [&good](auto change) {
    image_t image = good;
    change(image);
    return error_of(image);
  };
  EXPECT_THAT(with([](image_t& i) { i.width = -1; }), HasSubstr("width is -1"));
  EXPECT_THAT(with([](image_t& i) { i.height = 2000000000; }), HasSubstr("height is 2000000000"));
  EXPECT_THAT(with([](image_t& i) { i.row_stride = 63; }), HasSubstr("row_stride is 63"));
  EXPECT_THAT(with([](image_t& i) { i.row_stride = 2147483647; }), HasSubstr("size is"));
  EXPECT_THAT(with([](image_t& i) { i.row_stride = -64; }), HasSubstr("row_stride is -64"));
  EXPECT_THAT(with([](image_t& i) { i.height = 49; }), HasSubstr("size is 3072"));
  EXPECT_THAT(with([](image_t& i) { i.size = 5; }), AllOf(HasSubstr("size is 5"), HasSubstr("3072")));
  EXPECT_THAT(with([](image_t& i) { i.pixelformat = 0; }), HasSubstr("pixelformat is 0"));
  EXPECT_THAT(with([](image_t& i) { i.pixelformat = image_t::PIXEL_FORMAT_RGB; }), HasSubstr("row_stride"));
}

TEST(ImageCodec, DamagedJpegIsRefusedSilently) {
  const image_t good = make_jpeg_image(0, picture(1, 320, 240), 90);
  ::testing::internal::CaptureStderr();
  image_t cut = good;
  cut.data.resize(cut.data.size() / 2);
  cut.size = static_cast<int32_t>(cut.data.size());
  EXPECT_THAT(error_of(cut), HasSubstr("truncated"));
  image_t holed = good;  // a lost block, as a bad disk or memory card leaves it
  std::fill_n(holed.data.begin() + holed.size / 2, 2000, uint8_t{0});
  EXPECT_THAT(error_of(holed), HasSubstr("corrupt JPEG"));
  image_t lying = good;
  lying.width = 640;
  EXPECT_THAT(error_of(lying), AllOf(HasSubstr("320 x 240"), HasSubstr("640 x 240")));
  image_t none = good;
  none.data = {0xFF, 0xD8, 0xFF, 0xD9};
  none.size = 4;
  error_of(none);
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  image_t padded = good;
  padded.data.resize(padded.data.size() + 100, 0);
  padded.size = static_cast<int32_t>(padded.data.size());
  EXPECT_EQ(decode_grey(padded).error_text(), "");
}

TEST(ImageCodec, RandomDamageNeverCrashes) {
  std::mt19937 random(1);
  const image_t good = make_jpeg_image(0, picture(1), 90);
  for (int i = 0; i < 2000; ++i) {
    image_t bad = good;
    for (int k = 0; k < 3; ++k) bad.data[random() % bad.data.size()] = static_cast<uint8_t>(random());
    if (i % 2 == 0) bad.data.resize(random() % bad.data.size());
    bad.size = static_cast<int32_t>(bad.data.size());
    const Result<cv::Mat> out = decode_grey(bad);
    EXPECT_TRUE(!out || out->size() == cv::Size(64, 48));
  }
}

TEST(ImageCodec, Metadata) {
  image_t image = make_grey_image(0, picture(1));
  EXPECT_EQ(metadata(image, "a"), "");
  set_metadata(&image, "a", "one");
  set_metadata(&image, "b", "two");
  set_metadata(&image, "a", "three");
  image_t back;
  ASSERT_TRUE(Bus::decode(encode_message(image), &back));
  EXPECT_EQ(back.nmetadata, 2);
  EXPECT_EQ(metadata(back, "a"), "three");
  EXPECT_EQ(metadata(back, "b"), "two");
}

TEST(ImageCodec, ReducedImagesLookLikeTheWhole) {
  cv::Mat grey(51, 67, CV_8U);
  for (int y = 0; y < grey.rows; ++y)
    for (int x = 0; x < grey.cols; ++x) grey.at<uint8_t>(y, x) = static_cast<uint8_t>(2 * x + y);
  cv::Mat bgr;
  cv::cvtColor(grey, bgr, cv::COLOR_GRAY2BGR);
  for (const image_t& image : {make_grey_image(1, grey), make_rgb_image(1, bgr), make_jpeg_image(1, grey, 95)}) {
    for (const int reduction : {1, 2, 4, 8}) {
      const cv::Mat reduced = decode_reduced_grey(image, reduction).value();
      ASSERT_EQ(reduced.size(), cv::Size((67 + reduction - 1) / reduction, (51 + reduction - 1) / reduction));
      EXPECT_NEAR(cv::mean(reduced)[0], cv::mean(grey)[0], 2 + reduction) << reduction;
      EXPECT_NEAR(reduced.at<uint8_t>(24 / reduction, 32 / reduction), 2 * 32 + 24, 2 * reduction + 4) << reduction;
    }
  }
  image_t truncated = make_jpeg_image(1, grey);
  truncated.data.resize(truncated.data.size() / 2);
  truncated.size = static_cast<int32_t>(truncated.data.size());
  EXPECT_FALSE(decode_reduced_grey(truncated, 4));
  EXPECT_FALSE(decode_reduced_grey(image_t{}, 4));
}

}  // namespace
}  // namespace rumi::camera_driver
