// SPDX-License-Identifier: BSD-3-Clause
// Converts the pixels of sensor_msgs/Image.
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

#include "base/result.h"
#include "formats/bag/ros_messages.h"

namespace rumi {

// Returns BGR if the image has colour and `colour` is true, else grey; 8 or 16 bits. The pixels may lie in the message,
// which must outlive them. An Error if the encoding is not read, or the sizes do not fit.
Result<cv::Mat> pixels_of(const RosImage& image, bool colour);
// True if pixels are distances instead of brightness.
bool is_depth_encoding(const std::string& encoding);

}  // namespace rumi
