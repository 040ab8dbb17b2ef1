// SPDX-License-Identifier: BSD-3-Clause
// The pixels of sensor_msgs/Image.
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

#include "formats/bag/ros_messages.h"

namespace rumi {

// Grey, or BGR if they have colour and `colour` is wanted; of 8 or 16 bits, and they may be those of the message.
// Empty, and why in *error, if there are none.
cv::Mat pixels_of(const RosImage& image, bool colour, std::string* error);
// Distances instead of brightness.
bool is_depth_encoding(const std::string& encoding);

}  // namespace rumi
