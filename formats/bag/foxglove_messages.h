// SPDX-License-Identifier: BSD-3-Clause
// Images and calibrations as Foxglove's own programs write them into MCAP files: by protobuf, or as JSON.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/bag/bag_file.h"

namespace rumi {

// "sensor_msgs/CompressedImage" for "foxglove.CompressedImage"; empty for what is not read.
std::string ros_type_of_foxglove(const std::string& type);

// Converts the message to ROS 1's form; empty if the bytes are no such message. `encoding`: kProtobuf or kJson;
// `ros_type`: as above.
std::vector<uint8_t> ros_message_of_foxglove(std::span<const uint8_t> message, RosEncoding encoding,
                                             const std::string& ros_type);

}  // namespace rumi
