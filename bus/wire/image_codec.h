// SPDX-License-Identifier: BSD-3-Clause
// image_t <-> pixels.
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <string_view>

#include "base/result.h"
#include "lcmtypes/rumi/image_t.hpp"

namespace rumi {

// An Error names the field and its value. Looks at a JPEG's size and end, not at its pixels.
Result<> check_image(const image_t& image);

// 8-bit grey image, width x height as the message says. Decodes GRAY, RGB, MJPEG (JPEG) and YUYV; Errors are those of
// check_image(), and damage in a JPEG's pixels.
Result<cv::Mat> decode_grey(const image_t& image);
// Decodes the image as many times smaller as `reduction` says (1, 2, 4 or 8; sizes are rounded up): cheaper than
// decoding in full.
Result<cv::Mat> decode_reduced_grey(const image_t& image, int reduction);
// 8-bit BGR (OpenCV's order); Errors as decode_grey().
Result<cv::Mat> decode_bgr(const image_t& image);

image_t make_grey_image(int64_t utime_us, const cv::Mat& grey);
image_t make_rgb_image(int64_t utime_us, const cv::Mat& bgr);
// JPEG bytes as they are (not decoded); width and height must be right.
image_t wrap_jpeg(int64_t utime_us, int width, int height, std::vector<uint8_t> jpeg);

// The metadata entry `key`, empty if there is none; valid as long as the image and its entry.
std::string_view metadata(const image_t& image, std::string_view key);
void set_metadata(image_t* image, const std::string& key, std::string_view value);
inline constexpr const char* kCalibrationKey = "calibration";
// Decimal microseconds of the system clock when the image was put on the bus; live only.
inline constexpr const char* kPublishedKey = "published_utime";

}  // namespace rumi
