// SPDX-License-Identifier: BSD-3-Clause
#include "formats/bag/ros_pixels.h"

#include <gmock/gmock.h>

namespace rumi {
namespace {

using ::testing::HasSubstr;

RosImage image_of(const std::vector<uint8_t>& data, uint32_t width, uint32_t height, const std::string& encoding) {
  RosImage image;
  image.width = width, image.height = height, image.encoding = encoding, image.data = data;
  image.step = static_cast<uint32_t>(data.size() / height);
  return image;
}

// Returns the values of the first pixel: blue, green, red; or one if the image is grey.
std::vector<int> first_pixel(const RosImage& image, bool colour) {
  const cv::Mat pixels = pixels_of(image, colour).value();
  std::vector<int> values;
  for (int i = 0; i < pixels.channels(); ++i)
    values.push_back(pixels.depth() == CV_16U ? pixels.ptr<uint16_t>(0)[i] : pixels.ptr(0)[i]);
  return values;
}

using Values = std::vector<int>;

TEST(RosPixels, HaveTheOrderOfTheirEncoding) {
  EXPECT_EQ(first_pixel(image_of({1, 2, 3}, 1, 1, "rgb8"), true), (Values{3, 2, 1}));
  EXPECT_EQ(first_pixel(image_of({1, 2, 3}, 1, 1, "bgr8"), true), (Values{1, 2, 3}));
  EXPECT_EQ(first_pixel(image_of({1, 2, 3, 9}, 1, 1, "rgba8"), true), (Values{3, 2, 1}));
  EXPECT_EQ(first_pixel(image_of({1, 2, 3, 9}, 1, 1, "bgra8"), true), (Values{1, 2, 3}));
  EXPECT_EQ(first_pixel(image_of({255, 0, 0}, 1, 1, "rgb8"), false), (Values{76}));
  EXPECT_EQ(first_pixel(image_of({255, 0, 0}, 1, 1, "bgr8"), false), (Values{29}));
  EXPECT_EQ(first_pixel(image_of({7}, 1, 1, "mono8"), true), (Values{7}));
  EXPECT_EQ(first_pixel(image_of({128, 7, 128, 8}, 2, 1, "yuv422"), false), (Values{7}));
  EXPECT_EQ(first_pixel(image_of({7, 128, 8, 128}, 2, 1, "yuv422_yuy2"), false), (Values{7}));
}

TEST(RosPixels, Of16BitsAreInEitherOrder) {
  const std::vector<uint8_t> data = {1, 2};
  RosImage image = image_of(data, 1, 1, "mono16");
  EXPECT_EQ(first_pixel(image, false), (Values{0x0201}));
  image.is_big_endian = true;
  EXPECT_EQ(first_pixel(image, false), (Values{0x0102}));
}

TEST(RosPixels, OfABayerPatternAreRedWhereRedIs) {
  // 4 x 4 pixels: in each 2 x 2 pixels of the pattern the first one is 200, the others are 0.
  std::vector<uint8_t> data(16);
  for (size_t y = 0; y < 4; y += 2)
    for (size_t x = 0; x < 4; x += 2) data[4 * y + x] = 200;
  const cv::Vec3b red = pixels_of(image_of(data, 4, 4, "bayer_rggb8"), true).value().at<cv::Vec3b>(2, 2);
  EXPECT_EQ(red, cv::Vec3b(0, 0, 200));
  const cv::Vec3b blue = pixels_of(image_of(data, 4, 4, "bayer_bggr8"), true).value().at<cv::Vec3b>(2, 2);
  EXPECT_EQ(blue, cv::Vec3b(200, 0, 0));
  for (const char* green : {"bayer_grbg8", "bayer_gbrg8"})
    EXPECT_EQ(pixels_of(image_of(data, 4, 4, green), true).value().at<cv::Vec3b>(2, 2)[1], 200) << green;
}

TEST(RosPixels, MayHaveBytesBehindTheirRows) {
  const std::vector<uint8_t> data = {1, 2, 99, 3, 4};  // the last row may lack its padding
  RosImage image = image_of(data, 2, 2, "mono8");
  image.step = 3;
  EXPECT_EQ(pixels_of(image, false).value().at<uint8_t>(1, 0), 3);
  image.step = 4;
  EXPECT_THAT(pixels_of(image, false).error_text(), HasSubstr("5 bytes"));
  image.step = 1;
  EXPECT_THAT(pixels_of(image, false).error_text(), HasSubstr("rows of 1 bytes"));
}

TEST(RosPixels, OfOtherKindsOrSizesAreRefused) {
  const std::vector<uint8_t> data(16);
  for (const auto& [width, height, encoding, says] : {std::tuple{2u, 2u, "32FC1", "distances"},
                                                      {2u, 2u, "nv12", "'nv12'"},
                                                      {2u, 2u, "\n\x80", "encoding '?"},
                                                      {0u, 1u, "mono8", "0 x 1 pixels"},
                                                      {4'000'000'000u, 1u, "mono8", "pixels"},
                                                      {3u, 1u, "yuv422", "pairs"}}) {
    EXPECT_THAT(pixels_of(image_of(data, width, height, encoding), false).error_text(), HasSubstr(says));
  }
}

}  // namespace
}  // namespace rumi
