// SPDX-License-Identifier: BSD-3-Clause
#include "formats/bag/ros_pixels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "slam/geometry/max_side.h"

namespace rumi {
namespace {

constexpr int kAsItIs = -1;

struct PixelKind {
  const char* encoding;
  int type;
  int to_grey = kAsItIs, to_bgr = kAsItIs;  // conversions of OpenCV
};

// OpenCV names a Bayer pattern by the second row's second and third pixel, ROS by the first row's first two.
constexpr std::array kKinds = {
    PixelKind{"mono8", CV_8UC1},
    PixelKind{"8UC1", CV_8UC1},
    PixelKind{"mono16", CV_16UC1},
    PixelKind{"16UC1", CV_16UC1},
    PixelKind{"rgb8", CV_8UC3, cv::COLOR_RGB2GRAY, cv::COLOR_RGB2BGR},
    PixelKind{"bgr8", CV_8UC3, cv::COLOR_BGR2GRAY},
    PixelKind{"8UC3", CV_8UC3, cv::COLOR_BGR2GRAY},
    PixelKind{"rgba8", CV_8UC4, cv::COLOR_RGBA2GRAY, cv::COLOR_RGBA2BGR},
    PixelKind{"bgra8", CV_8UC4, cv::COLOR_BGRA2GRAY, cv::COLOR_BGRA2BGR},
    PixelKind{"8UC4", CV_8UC4, cv::COLOR_BGRA2GRAY, cv::COLOR_BGRA2BGR},
    PixelKind{"rgb16", CV_16UC3, cv::COLOR_RGB2GRAY, cv::COLOR_RGB2BGR},
    PixelKind{"bgr16", CV_16UC3, cv::COLOR_BGR2GRAY},
    PixelKind{"bayer_rggb8", CV_8UC1, cv::COLOR_BayerBG2GRAY, cv::COLOR_BayerBG2BGR},
    PixelKind{"bayer_bggr8", CV_8UC1, cv::COLOR_BayerRG2GRAY, cv::COLOR_BayerRG2BGR},
    PixelKind{"bayer_gbrg8", CV_8UC1, cv::COLOR_BayerGR2GRAY, cv::COLOR_BayerGR2BGR},
    PixelKind{"bayer_grbg8", CV_8UC1, cv::COLOR_BayerGB2GRAY, cv::COLOR_BayerGB2BGR},
    PixelKind{"bayer_rggb16", CV_16UC1, cv::COLOR_BayerBG2GRAY, cv::COLOR_BayerBG2BGR},
    PixelKind{"bayer_bggr16", CV_16UC1, cv::COLOR_BayerRG2GRAY, cv::COLOR_BayerRG2BGR},
    PixelKind{"bayer_gbrg16", CV_16UC1, cv::COLOR_BayerGR2GRAY, cv::COLOR_BayerGR2BGR},
    PixelKind{"bayer_grbg16", CV_16UC1, cv::COLOR_BayerGB2GRAY, cv::COLOR_BayerGB2BGR},
    PixelKind{"yuv422", CV_8UC2, cv::COLOR_YUV2GRAY_UYVY, cv::COLOR_YUV2BGR_UYVY},
    PixelKind{"uyvy", CV_8UC2, cv::COLOR_YUV2GRAY_UYVY, cv::COLOR_YUV2BGR_UYVY},
    PixelKind{"yuv422_yuy2", CV_8UC2, cv::COLOR_YUV2GRAY_YUY2, cv::COLOR_YUV2BGR_YUY2},
    PixelKind{"yuyv", CV_8UC2, cv::COLOR_YUV2GRAY_YUY2, cv::COLOR_YUV2BGR_YUY2},
};

// True if two pixels share their colour.
bool is_of_pairs(const std::string& encoding) { return encoding.starts_with("yu") || encoding == "uyvy"; }

std::string printable(std::string text) {
  constexpr size_t kMost = 40;
  if (text.size() > kMost) text = text.substr(0, kMost) + "...";
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < ' ' || c > '~'; }, '?');
  return text;
}

std::string why_unknown(const std::string& encoding) {
  if (is_depth_encoding(encoding))
    return fmt::format("is of encoding '{}': distances, or brightness as floating-point numbers, which are not read",
                       printable(encoding));
  return fmt::format(
      "is of encoding '{}', which is not read; mono8, mono16, rgb8, bgr8, rgba8, bgra8, bayer_* and yuv422 are",
      printable(encoding));
}

Result<> check_sizes(const RosImage& image, size_t row_bytes, size_t step) {
  if (image.width < 1 || image.height < 1 || image.width > kMaxSide || image.height > kMaxSide)
    return Error{fmt::format("has {} x {} pixels: must have 1 to {} a side", image.width, image.height, kMaxSide)};
  if (is_of_pairs(image.encoding) && image.width % 2 != 0)
    return Error{fmt::format("has {} pixels a row: {} has pairs of them", image.width, image.encoding)};
  if (step < row_bytes)
    return Error{fmt::format("has rows of {} bytes: {} pixels of {} take {}", step, image.width,
                             printable(image.encoding), row_bytes)};
  if (image.data.size() < step * (image.height - 1) + row_bytes)
    return Error{fmt::format("has {} bytes of pixels: {} rows of {} take more", image.data.size(), image.height, step)};
  return {};
}

// Returns a copy in this computer's byte order, with aligned rows.
cv::Mat copy_of_16_bit(const RosImage& image, int type, size_t row_bytes, size_t step) {
  cv::Mat pixels(static_cast<int>(image.height), static_cast<int>(image.width), type);
  for (int y = 0; y < pixels.rows; ++y) {
    uint8_t* row = pixels.ptr(y);
    std::memcpy(row, image.data.data() + static_cast<size_t>(y) * step, row_bytes);
    for (size_t i = 0; image.is_big_endian && i + 1 < row_bytes; i += 2) std::swap(row[i], row[i + 1]);
  }
  return pixels;
}

}  // namespace

bool is_depth_encoding(const std::string& encoding) {
  return encoding.starts_with("32FC") || encoding.starts_with("64FC") || encoding == "16UC1";
}

Result<cv::Mat> pixels_of(const RosImage& image, bool colour) {
  const auto kind =
      std::find_if(kKinds.begin(), kKinds.end(), [&](const PixelKind& one) { return one.encoding == image.encoding; });
  if (kind == kKinds.end()) return Error{why_unknown(image.encoding)};
  const size_t row_bytes = size_t{image.width} * static_cast<size_t>(CV_ELEM_SIZE(kind->type));
  const size_t step = image.step == 0 ? row_bytes : image.step;
  if (const Result<> checked = check_sizes(image, row_bytes, step); !checked) return checked.error();
  const bool is_wide = CV_MAT_DEPTH(kind->type) == CV_16U;
  // The const_cast below is safe: OpenCV does not change pixels of its inputs.
  const cv::Mat stored = is_wide ? copy_of_16_bit(image, kind->type, row_bytes, step)
                                 : cv::Mat(static_cast<int>(image.height), static_cast<int>(image.width), kind->type,
                                           const_cast<uint8_t*>(image.data.data()), step);
  const int conversion = colour ? kind->to_bgr : kind->to_grey;
  if (conversion == kAsItIs) return stored;
  cv::Mat pixels;
  try {
    cv::cvtColor(stored, pixels, conversion);
  } catch (const cv::Exception&) {
    return Error{
        fmt::format("has {} x {} pixels, which cannot be of encoding {}", image.width, image.height, kind->encoding)};
  }
  return pixels;
}

}  // namespace rumi
