// SPDX-License-Identifier: BSD-3-Clause
// Parses messages of ROS, as ROS 1 or ROS 2 (CDR) writes them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/bag/bag_file.h"
#include "slam/geometry/transform.h"

namespace rumi {

using Bytes = std::span<const uint8_t>;

struct RosImage {  // sensor_msgs/Image
  uint32_t height = 0, width = 0, step = 0;
  std::string encoding;
  bool is_big_endian = false;
  Bytes data;
};

struct RosCompressedImage {
  std::string format;
  Bytes data;
};

struct RosCameraInfo {
  uint32_t height = 0, width = 0;
  std::string distortion_model;
  std::vector<double> d;
  std::array<double, 9> k{}, r{};
  std::array<double, 12> p{};
  uint32_t binning_x = 0, binning_y = 0;
  uint32_t roi_x = 0, roi_y = 0, roi_height = 0, roi_width = 0;
};

struct RosTransform {  // geometry_msgs/TransformStamped
  int64_t stamp_ns = 0;
  std::string parent, child;  // frames, without a slash before them
  SE3 parent_from_child;
};

// Each returns false if the bytes are no such message. Data of images are not copied: they point into the bytes.
bool parse(Bytes message, RosEncoding encoding, RosImage* image);
bool parse(Bytes message, RosEncoding encoding, RosCompressedImage* image);
bool parse(Bytes message, RosEncoding encoding, RosCameraInfo* info);
bool parse(Bytes message, RosEncoding encoding,
           std::vector<RosTransform>* transforms);  // TFMessage; invalid transforms are left out
// Reads the stamp of the header with which messages of images and calibrations begin; the first kHeadBytes are enough.
int64_t stamp_ns(Bytes head, RosEncoding encoding);
// Returns the frame that such a header names, without a leading slash; empty if it names none.
std::string frame_of(Bytes message, RosEncoding encoding);

}  // namespace rumi
