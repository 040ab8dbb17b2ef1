// SPDX-License-Identifier: BSD-3-Clause
// Converts images and calibrations that Foxglove's own programs write into MCAP files, by protobuf or as JSON.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/bag/bag_file.h"

namespace rumi {

// Returns "sensor_msgs/CompressedImage" for "foxglove.CompressedImage", and so on; empty for types that are not read.
std::string ros_type_of_foxglove(const std::string& type);

// Converts the message to ROS 1's form; empty if the bytes are no such message. `encoding`: kProtobuf or kJson;
// `ros_type`: as above.
std::vector<uint8_t> ros_message_of_foxglove(std::span<const uint8_t> message, RosEncoding encoding,
                                             const std::string& ros_type);

}  // namespace rumi
