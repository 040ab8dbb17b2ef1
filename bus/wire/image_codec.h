// SPDX-License-Identifier: BSD-3-Clause
// Converts between image_t and pixels.
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <string_view>

#include "base/result.h"
#include "lcmtypes/rumi/image_t.hpp"

namespace rumi {

// Checks that the image can be decoded; an Error names the field and its value. Looks at a JPEG's size and end, not at
// its pixels.
Result<> check_image(const image_t& image);

// Decodes GRAY, RGB, MJPEG (JPEG) and YUYV to an 8-bit grey image of the message's width and height. The Errors are
// those of check_image(), and one for damage in a JPEG's pixels.
Result<cv::Mat> decode_grey(const image_t& image);
// Decodes to grey with both sides divided by `reduction` (1, 2, 4 or 8) and rounded up; Errors as decode_grey(). For a
// JPEG this is cheaper than decoding in full.
Result<cv::Mat> decode_reduced_grey(const image_t& image, int reduction);
// Decodes to 8-bit BGR (OpenCV's order); Errors as decode_grey().
Result<cv::Mat> decode_bgr(const image_t& image);

image_t make_grey_image(int64_t utime_us, const cv::Mat& grey);
image_t make_rgb_image(int64_t utime_us, const cv::Mat& bgr);
// Makes a message of JPEG bytes as they are (not decoded); width and height must be those of the JPEG.
image_t wrap_jpeg(int64_t utime_us, int width, int height, std::vector<uint8_t> jpeg);

// Returns the metadata entry `key`, empty if the image has no such entry; valid as long as the image and its entry.
std::string_view metadata(const image_t& image, std::string_view key);
void set_metadata(image_t* image, const std::string& key, std::string_view value);
inline constexpr const char* kCalibrationKey = "calibration";
// The system clock when the image was put on the bus, in decimal microseconds; live only.
inline constexpr const char* kPublishedKey = "published_utime";

}  // namespace rumi
