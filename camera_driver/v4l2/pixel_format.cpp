// SPDX-License-Identifier: BSD-3-Clause
#include "camera_driver/v4l2/pixel_format.h"

#include <fmt/format.h>
#include <linux/videodev2.h>

#include <opencv2/imgproc.hpp>

#include "bus/wire/image_codec.h"

namespace rumi::camera_driver {
namespace {

cv::Mat view(const RawImage& raw, int type, size_t offset = 0) {
  return {raw.height, raw.width, type, const_cast<uint8_t*>(raw.data.data()) + offset, static_cast<size_t>(raw.stride)};
}

// OpenCV wants the planes of 4:2:0 without padding, one below the other.
cv::Mat compact_420(const PixelFormat& format, const RawImage& raw) {
  cv::Mat out(raw.height * 3 / 2, raw.width, CV_8UC1);
  view(raw, CV_8UC1).copyTo(out.rowRange(0, raw.height));
  const bool planar = format.layout == PixelLayout::kPlanarYuv;
  const int rows = planar ? raw.height : raw.height / 2;  // chroma rows
  const int width = planar ? raw.width / 2 : raw.width, stride = planar ? raw.stride / 2 : raw.stride;
  const size_t offset = static_cast<size_t>(raw.stride) * raw.height;
  const cv::Mat from(rows, width, CV_8UC1, const_cast<uint8_t*>(raw.data.data()) + offset, static_cast<size_t>(stride));
  from.copyTo(cv::Mat(rows, width, CV_8UC1, out.ptr(raw.height)));
  return out;
}

cv::Mat grey_pixels(const PixelFormat& format, const RawImage& raw) {
  cv::Mat out;
  switch (format.layout) {
    case PixelLayout::kPackedYuv:
      cv::cvtColor(view(raw, CV_8UC2), out, format.to_grey);
      return out;
    case PixelLayout::kRgb:
      cv::cvtColor(view(raw, CV_8UC3), out, format.to_grey);
      return out;
    case PixelLayout::kBayer:
      cv::cvtColor(view(raw, CV_8UC1), out, format.to_grey);
      return out;
    default:  // the first plane is the brightness
      return view(raw, CV_8UC1);
  }
}

cv::Mat bgr_pixels(const PixelFormat& format, const RawImage& raw) {
  cv::Mat out;
  switch (format.layout) {
    case PixelLayout::kPackedYuv:
      cv::cvtColor(view(raw, CV_8UC2), out, format.to_bgr);
      return out;
    case PixelLayout::kRgb:
      if (format.to_bgr < 0) return view(raw, CV_8UC3);
      cv::cvtColor(view(raw, CV_8UC3), out, format.to_bgr);
      return out;
    case PixelLayout::kBayer:
      cv::cvtColor(view(raw, CV_8UC1), out, format.to_bgr);
      return out;
    default:
      cv::cvtColor(compact_420(format, raw), out, format.to_bgr);
      return out;
  }
}

}  // namespace

const std::vector<PixelFormat>& pixel_formats() {
  using L = PixelLayout;
  // OpenCV's old Bayer names follow the second row of pixels; these aliases follow the first row, as V4L2's names do.
  static const std::vector<PixelFormat> kFormats = {
      {V4L2_PIX_FMT_GREY, "grey", L::kGrey},
      {V4L2_PIX_FMT_NV12, "nv12", L::kNv, -1, cv::COLOR_YUV2BGR_NV12},
      {V4L2_PIX_FMT_NV21, "nv21", L::kNv, -1, cv::COLOR_YUV2BGR_NV21},
      {V4L2_PIX_FMT_YUV420, "yu12", L::kPlanarYuv, -1, cv::COLOR_YUV2BGR_I420},
      {V4L2_PIX_FMT_YVU420, "yv12", L::kPlanarYuv, -1, cv::COLOR_YUV2BGR_YV12},
      {V4L2_PIX_FMT_YUYV, "yuyv", L::kPackedYuv, cv::COLOR_YUV2GRAY_YUY2, cv::COLOR_YUV2BGR_YUY2},
      {V4L2_PIX_FMT_YVYU, "yvyu", L::kPackedYuv, cv::COLOR_YUV2GRAY_YVYU, cv::COLOR_YUV2BGR_YVYU},
      {V4L2_PIX_FMT_UYVY, "uyvy", L::kPackedYuv, cv::COLOR_YUV2GRAY_UYVY, cv::COLOR_YUV2BGR_UYVY},
      {V4L2_PIX_FMT_MJPEG, "mjpeg", L::kJpeg},
      {V4L2_PIX_FMT_JPEG, "jpeg", L::kJpeg},
      {V4L2_PIX_FMT_RGB24, "rgb24", L::kRgb, cv::COLOR_RGB2GRAY, cv::COLOR_RGB2BGR},
      {V4L2_PIX_FMT_BGR24, "bgr24", L::kRgb, cv::COLOR_BGR2GRAY, -1},
      {V4L2_PIX_FMT_SRGGB8, "rggb8", L::kBayer, cv::COLOR_BayerRGGB2GRAY, cv::COLOR_BayerRGGB2BGR},
      {V4L2_PIX_FMT_SGRBG8, "grbg8", L::kBayer, cv::COLOR_BayerGRBG2GRAY, cv::COLOR_BayerGRBG2BGR},
      {V4L2_PIX_FMT_SGBRG8, "gbrg8", L::kBayer, cv::COLOR_BayerGBRG2GRAY, cv::COLOR_BayerGBRG2BGR},
      {V4L2_PIX_FMT_SBGGR8, "bggr8", L::kBayer, cv::COLOR_BayerBGGR2GRAY, cv::COLOR_BayerBGGR2BGR},
  };
  return kFormats;
}

const PixelFormat* find_pixel_format(uint32_t fourcc) {
  for (const PixelFormat& format : pixel_formats())
    if (format.fourcc == fourcc) return &format;
  return nullptr;
}

std::string fourcc_text(uint32_t fourcc) {
  std::string text;
  for (int i = 0; i < 4; ++i) {
    const char c = static_cast<char>(fourcc >> (8 * i) & 0x7F);
    text += c >= ' ' && c < 0x7F ? c : '?';
  }
  while (text.ends_with(' ')) text.pop_back();
  return text;
}

int64_t row_bytes(const PixelFormat& format, int width) {
  switch (format.layout) {
    case PixelLayout::kJpeg:
      return 0;
    case PixelLayout::kPackedYuv:
      return int64_t{2} * width;
    case PixelLayout::kRgb:
      return int64_t{3} * width;
    default:
      return width;
  }
}

std::optional<int64_t> frame_bytes(const PixelFormat& format, int width, int height, int stride) {
  const int64_t h = height, s = stride, row = row_bytes(format, width);
  const bool even_width = width % 2 == 0, even = even_width && height % 2 == 0;
  if (row < 1 || h < 1 || s < row) return std::nullopt;
  switch (format.layout) {
    case PixelLayout::kPackedYuv:
      return even_width ? std::optional(s * (h - 1) + row) : std::nullopt;
    case PixelLayout::kBayer:
      return even ? std::optional(s * (h - 1) + row) : std::nullopt;
    case PixelLayout::kNv:
      return even ? std::optional(s * (h + h / 2 - 1) + row) : std::nullopt;
    case PixelLayout::kPlanarYuv:
      return even && s % 2 == 0 ? std::optional(s * h + s / 2 * (h - 1) + row / 2) : std::nullopt;
    default:
      return s * (h - 1) + row;
  }
}

Result<image_t> jpeg_image(const RawImage& raw) {
  image_t image = wrap_jpeg(0, raw.width, raw.height, {raw.data.begin(), raw.data.end()});
  if (const Result<> checked = check_image(image); !checked) return checked.error();
  return image;
}

Result<cv::Mat> to_pixels(const PixelFormat& format, const RawImage& raw, bool colour) {
  const std::optional<int64_t> needed = frame_bytes(format, raw.width, raw.height, raw.stride);
  if (!needed || static_cast<int64_t>(raw.data.size()) < *needed)
    return Error{fmt::format("has {} bytes: must be at least {}", raw.data.size(), needed.value_or(0))};
  return colour && format.layout != PixelLayout::kGrey ? bgr_pixels(format, raw) : grey_pixels(format, raw);
}

}  // namespace rumi::camera_driver
