// SPDX-License-Identifier: BSD-3-Clause
// The V4L2 pixel formats that we understand, and how their pixels become an image_t.
// Layouts: Linux Media Infrastructure userspace API, "Image Formats".
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lcmtypes/rumi/image_t.hpp"

namespace rumi::camera_driver {

enum class PixelLayout {
  kGrey,
  kPackedYuv,  // 4:2:2, two bytes per pixel
  kNv,         // 4:2:0, Y then interleaved chroma
  kPlanarYuv,  // 4:2:0, Y then two planes of chroma
  kRgb,        // three bytes per pixel
  kBayer,      // 8 bit
  kJpeg,
};

struct PixelFormat {
  uint32_t fourcc = 0;
  std::string option;  // its name in camera_driver.format
  PixelLayout layout = PixelLayout::kGrey;
  int to_grey = -1, to_bgr = -1;  // cv::ColorConversionCodes; -1: not needed
};

// In the order in which they are preferred: least work and least loss first.
const std::vector<PixelFormat>& pixel_formats();
const PixelFormat* find_pixel_format(uint32_t fourcc);
// "YUYV"; what is not printable as '?'.
std::string fourcc_text(uint32_t fourcc);

// A frame as the driver left it in its buffer.
struct RawImage {
  std::span<const uint8_t> data;
  int width = 0, height = 0, stride = 0;  // pixels, pixels, bytes (of the first plane; unused with JPEG)
};

// Bytes of a row's pixels (of the first plane); 0 for JPEG.
int64_t row_bytes(const PixelFormat& format, int width);
// Bytes that such a frame has at least; nothing if that cannot be: a stride shorter than a row, an odd size where
// pixels come in pairs. Not for JPEG.
std::optional<int64_t> frame_bytes(const PixelFormat& format, int width, int height, int stride);

// JPEG as it is, anything else as grey or (`colour`) as RGB where there is colour. The time is 0. Nothing, and why in
// *error, if the data is too short or, for JPEG, broken or of another size.
std::optional<image_t> to_image(const PixelFormat& format, const RawImage& raw, bool colour, std::string* error);

}  // namespace rumi::camera_driver
