// SPDX-License-Identifier: BSD-3-Clause
#include "camera_driver/source/encode_as.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "bus/wire/image_codec.h"
#include "bus/wire/jpeg_image.h"
#include "tests/formats/recording.h"

namespace rumi::camera_driver {
namespace {

using testing::picture;

CameraOptions encoding(const std::string& name) {
  CameraOptions options;
  options.encoding = name;
  return options;
}

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

TEST(EncodeAs, PixelsKeepTheirColours) {
  const cv::Mat colour = picture(1, 64, 48, true), grey = picture(2);
  EXPECT_TRUE(same(decode_bgr(encode_pixels(5, colour, encoding("rgb"))).value(), colour));
  EXPECT_TRUE(same(decode_grey(encode_pixels(5, grey, encoding("grey"))).value(), grey));
  EXPECT_EQ(encode_pixels(5, colour, encoding("jpeg")).data, make_jpeg_image(5, colour).data);
  EXPECT_EQ(encode_pixels(5, grey, encoding("jpeg")).data, make_jpeg_image(5, grey).data);
  EXPECT_EQ(encode_pixels(5, grey, encoding("auto")).utime, 5);
  cv::Mat as_colour;
  cv::cvtColor(grey, as_colour, cv::COLOR_GRAY2BGR);
  EXPECT_TRUE(same(decode_bgr(encode_pixels(5, grey, encoding("rgb"))).value(), as_colour));
}

TEST(EncodeAs, AnImageThatHasTheFormAlreadyIsNotDecoded) {
  image_t broken = make_jpeg_image(5, picture(1));
  broken.data.resize(broken.data.size() / 2);
  broken.size = static_cast<int32_t>(broken.data.size());
  EXPECT_TRUE(encode_as(broken, encoding("jpeg")));
  EXPECT_TRUE(encode_as(broken, encoding("auto")));
  EXPECT_FALSE(encode_as(broken, encoding("grey")));
}

TEST(EncodeAs, OtherImagesAreDecoded) {
  const cv::Mat colour = picture(1, 64, 48, true);
  const image_t rgb = make_rgb_image(5, colour);
  EXPECT_EQ(encode_as(rgb, encoding("jpeg")).value().data, make_jpeg_image(5, colour).data);
  EXPECT_TRUE(same(decode_grey(encode_as(rgb, encoding("grey")).value()).value(), decode_grey(rgb).value()));
}

}  // namespace
}  // namespace rumi::camera_driver
