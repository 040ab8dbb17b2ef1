// SPDX-License-Identifier: BSD-3-Clause
#include "camera_driver/v4l2/pixel_format.h"

#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include "bus/wire/image_codec.h"

namespace rumi::camera_driver {
namespace {

constexpr int kWidth = 8, kHeight = 6;

struct Colour {
  uint8_t r, g, b;
  uint8_t y, u, v;  // BT.601, limited range
};
constexpr Colour kRed{255, 0, 0, 82, 90, 240}, kBlue{0, 0, 255, 41, 240, 110};

void put(std::vector<uint8_t>* out, int stride, std::initializer_list<uint8_t> pattern, int row_bytes, int rows) {
  for (int y = 0; y < rows; ++y) {
    const size_t begin = out->size();
    for (int x = 0; x < row_bytes; ++x) out->push_back(pattern.begin()[x % pattern.size()]);
    out->resize(begin + static_cast<size_t>(stride), 0xEE);
  }
}

// Returns an image of one colour in the layout that the format's specification gives, with `padding` bytes behind each
// row.
std::vector<uint8_t> plain(uint32_t fourcc, const Colour& c, int padding, int* stride) {
  std::vector<uint8_t> out;
  const auto packed = [&](std::initializer_list<uint8_t> pattern, int row_bytes) {
    *stride = row_bytes + padding;
    put(&out, *stride, pattern, row_bytes, kHeight);
  };
  const auto planes = [&](std::initializer_list<uint8_t> first, std::initializer_list<uint8_t> second) {
    packed({c.y}, kWidth);
    if (second.size() == 0) return put(&out, *stride, first, kWidth, kHeight / 2);
    put(&out, *stride / 2, first, kWidth / 2, kHeight / 2);
    put(&out, *stride / 2, second, kWidth / 2, kHeight / 2);
  };
  const auto bayer = [&](std::initializer_list<uint8_t> even, std::initializer_list<uint8_t> odd) {
    *stride = kWidth + padding;
    for (int y = 0; y < kHeight; ++y) put(&out, *stride, y % 2 == 0 ? even : odd, kWidth, 1);
  };
  switch (fourcc) {
    case V4L2_PIX_FMT_GREY:
      packed({c.y}, kWidth);
      break;
    case V4L2_PIX_FMT_YUYV:
      packed({c.y, c.u, c.y, c.v}, 2 * kWidth);
      break;
    case V4L2_PIX_FMT_YVYU:
      packed({c.y, c.v, c.y, c.u}, 2 * kWidth);
      break;
    case V4L2_PIX_FMT_UYVY:
      packed({c.u, c.y, c.v, c.y}, 2 * kWidth);
      break;
    case V4L2_PIX_FMT_RGB24:
      packed({c.r, c.g, c.b}, 3 * kWidth);
      break;
    case V4L2_PIX_FMT_BGR24:
      packed({c.b, c.g, c.r}, 3 * kWidth);
      break;
    case V4L2_PIX_FMT_NV12:
      planes({c.u, c.v}, {});
      break;
    case V4L2_PIX_FMT_NV21:
      planes({c.v, c.u}, {});
      break;
    case V4L2_PIX_FMT_YUV420:
      planes({c.u}, {c.v});
      break;
    case V4L2_PIX_FMT_YVU420:
      planes({c.v}, {c.u});
      break;
    case V4L2_PIX_FMT_SRGGB8:
      bayer({c.r, c.g}, {c.g, c.b});
      break;
    case V4L2_PIX_FMT_SGRBG8:
      bayer({c.g, c.r}, {c.b, c.g});
      break;
    case V4L2_PIX_FMT_SGBRG8:
      bayer({c.g, c.b}, {c.r, c.g});
      break;
    case V4L2_PIX_FMT_SBGGR8:
      bayer({c.b, c.g}, {c.g, c.r});
      break;
    default:
      break;
  }
  return out;
}

TEST(PixelFormat, EveryFormatGivesItsColourAndItsGrey) {
  for (const PixelFormat& format : pixel_formats()) {
    if (format.layout == PixelLayout::kJpeg) continue;
    for (const Colour& colour : {kRed, kBlue}) {
      for (const int padding : {0, 10}) {
        int stride = 0;
        const std::vector<uint8_t> data = plain(format.fourcc, colour, padding, &stride);
        ASSERT_FALSE(data.empty()) << format.option;
        const RawImage raw{data, kWidth, kHeight, stride};
        const cv::Mat grey = to_pixels(format, raw, false).value();
        ASSERT_EQ(grey.type(), CV_8UC1);
        const bool is_yuv = format.layout != PixelLayout::kRgb && format.layout != PixelLayout::kBayer;
        const double luma = 0.299 * colour.r + 0.587 * colour.g + 0.114 * colour.b;
        double darkest = 0, brightest = 0;
        cv::minMaxLoc(grey, &darkest, &brightest);
        EXPECT_NEAR(darkest, is_yuv ? colour.y : luma, 1) << format.option;
        EXPECT_NEAR(brightest, is_yuv ? colour.y : luma, 1) << format.option;
        if (format.layout == PixelLayout::kGrey) continue;
        const cv::Mat bgr = to_pixels(format, raw, true).value();
        ASSERT_EQ(bgr.type(), CV_8UC3);
        const cv::Mat expected(bgr.size(), CV_8UC3, cv::Scalar(colour.b, colour.g, colour.r));
        EXPECT_LE(cv::norm(bgr, expected, cv::NORM_INF), 3) << format.option;
      }
    }
  }
}

TEST(PixelFormat, ImpossibleSizesAndMissingBytes) {
  for (const PixelFormat& format : pixel_formats()) {
    if (format.layout == PixelLayout::kJpeg) continue;
    int stride = 0;
    const std::vector<uint8_t> data = plain(format.fourcc, kRed, 10, &stride);
    const std::optional<int64_t> needed = frame_bytes(format, kWidth, kHeight, stride);
    ASSERT_TRUE(needed) << format.option;
    EXPECT_LE(*needed, static_cast<int64_t>(data.size()));
    // A copy of exactly the needed size, so that a sanitizer reports a read of even one byte past its end.
    std::vector<uint8_t> exact(data.begin(), data.begin() + *needed);
    exact.shrink_to_fit();
    EXPECT_TRUE(to_pixels(format, {exact, kWidth, kHeight, stride}, true)) << format.option;
    exact.pop_back();
    EXPECT_FALSE(to_pixels(format, {exact, kWidth, kHeight, stride}, false)) << format.option;
    EXPECT_FALSE(frame_bytes(format, kWidth, kHeight, kWidth - 1)) << format.option;
    EXPECT_FALSE(frame_bytes(format, 0, kHeight, 100)) << format.option;
    const bool in_pairs = format.layout != PixelLayout::kGrey && format.layout != PixelLayout::kRgb;
    EXPECT_EQ(frame_bytes(format, 7, 6, 100).has_value(), !in_pairs) << format.option;
  }
}

TEST(PixelFormat, NamesThatCannotBePrinted) {
  EXPECT_EQ(fourcc_text(V4L2_PIX_FMT_YUYV), "YUYV");
  EXPECT_EQ(fourcc_text(0x1B5B1B5B), "[?[?");
}

}  // namespace
}  // namespace rumi::camera_driver
