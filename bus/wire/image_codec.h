// SPDX-License-Identifier: BSD-3-Clause
// image_t <-> pixels.
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

#include "lcmtypes/rumi/image_t.hpp"

namespace rumi {

// What is wrong with the message (field and value), or an empty string. Looks at a JPEG's size and end, not at its
// pixels.
std::string check_image(const image_t& image);

// 8-bit grey image, width x height as the message says. On failure an empty Mat and in *error what is wrong (field,
// value). Understands GRAY, RGB, MJPEG (JPEG) and YUYV.
cv::Mat decode_grey(const image_t& image, std::string* error);
// The same, as many times smaller as gives `reduction` (1, 2, 4 or 8; sizes rounded up): cheaper than decoding in full.
cv::Mat decode_reduced_grey(const image_t& image, int reduction, std::string* error);
// 8-bit BGR (OpenCV's order), as decode_grey().
cv::Mat decode_bgr(const image_t& image, std::string* error);

image_t make_grey_image(int64_t utime_us, const cv::Mat& grey);
image_t make_rgb_image(int64_t utime_us, const cv::Mat& bgr);
// JPEG bytes as they are (not decoded); width and height must be right.
image_t wrap_jpeg(int64_t utime_us, int width, int height, std::vector<uint8_t> jpeg);

// Metadata entry `key`, or an empty string.
std::string metadata(const image_t& image, const std::string& key);
void set_metadata(image_t* image, const std::string& key, const std::string& value);
inline constexpr const char* kCalibrationKey = "calibration";
// Decimal microseconds of the system clock when the image was put on the bus; live only.
inline constexpr const char* kPublishedKey = "published_utime";

}  // namespace rumi
