// SPDX-License-Identifier: BSD-3-Clause
// Lists the V4L2 pixel formats that are read, and converts their pixels for an image_t. Layouts: Linux Media
// Infrastructure userspace API, "Image Formats".
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "lcmtypes/rumi/image_t.hpp"

namespace rumi::camera_driver {

enum class PixelLayout {
  kGrey,
  kPackedYuv,  // 4:2:2, two bytes per pixel
  kNv,         // 4:2:0, Y then interleaved chroma
  kPlanarYuv,  // 4:2:0, Y then two planes of chroma
  kRgb,        // three bytes per pixel
  kBayer,      // one byte per pixel, a mosaic of colours
  kJpeg,
};

struct PixelFormat {
  uint32_t fourcc = 0;
  std::string option;  // its name in camera_driver.format
  PixelLayout layout = PixelLayout::kGrey;
  int to_grey = -1, to_bgr = -1;  // cv::ColorConversionCodes; -1: no conversion is needed
};

// Returns the formats in order of preference: least work and least loss first.
const std::vector<PixelFormat>& pixel_formats();
const PixelFormat* find_pixel_format(uint32_t fourcc);
// Returns the four letters, such as "YUYV"; letters that cannot be printed become '?'.
std::string fourcc_text(uint32_t fourcc);

// A frame as the driver left it in its buffer.
struct RawImage {
  std::span<const uint8_t> data;
  int width = 0, height = 0, stride = 0;  // pixels, pixels, bytes (of the first plane; unused with JPEG)
};

// Returns the bytes that a row's pixels take (in the first plane), without padding; 0 for JPEG.
int64_t row_bytes(const PixelFormat& format, int width);
// Returns the least number of bytes of a frame; nullopt for an impossible frame: the stride is shorter than a row, or a
// size is odd where pixels come in pairs. Not for JPEG.
std::optional<int64_t> frame_bytes(const PixelFormat& format, int width, int height, int stride);

// Returns the JPEG as a message, with time 0. An Error if it is broken or has another size.
Result<image_t> jpeg_image(const RawImage& raw);
// Converts a frame that is no JPEG to 8-bit pixels: BGR if the format has colour and `colour` is true, else grey. The
// result may lie in the driver's buffer. An Error if the data are too short.
Result<cv::Mat> to_pixels(const PixelFormat& format, const RawImage& raw, bool colour);

}  // namespace rumi::camera_driver
