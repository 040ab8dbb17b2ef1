// SPDX-License-Identifier: BSD-3-Clause
// The types of the messages that are written into bags, as ROS 1 and ROS 2 define them.
#pragma once

#include <string>

namespace rumi {

enum class Ros { k1, k2 };

// Types that are written. A bag holds their definitions, so that readers need not know them.
inline constexpr const char* kImageType = "sensor_msgs/Image";
inline constexpr const char* kCompressedImageType = "sensor_msgs/CompressedImage";
inline constexpr const char* kCameraInfoType = "sensor_msgs/CameraInfo";
inline constexpr const char* kPoseType = "geometry_msgs/PoseStamped";
inline constexpr const char* kPathType = "nav_msgs/Path";
inline constexpr const char* kTransformsType = "tf2_msgs/TFMessage";

// Returns the definition of a type, followed by those of the types in it, each behind a line of '='. Precondition: the
// type is one of the above.
std::string definition_of(const std::string& type, Ros ros);
// Returns the checksum by which ROS 1 tells definitions apart. Precondition: the type is one of the above.
std::string md5_of(const std::string& type);
// Returns "sensor_msgs/msg/Image" in ROS 2, "sensor_msgs/Image" in ROS 1.
std::string full_name(const std::string& type, Ros ros);

}  // namespace rumi
