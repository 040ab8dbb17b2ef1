// SPDX-License-Identifier: BSD-3-Clause
// Writes images, calibrations and poses as messages of ROS 1, or of ROS 2 (CDR).
#pragma once

#include <string>
#include <vector>

#include "formats/bag_writer/ros_types.h"
#include "formats/truth/trajectory.h"
#include "lcmtypes/rumi/image_t.hpp"
#include "slam/geometry/camera.h"

namespace rumi {

// Names of the frames. The camera's axes are x right, y down, z forward, as in ROS's optical frames.
inline constexpr const char* kMapFrame = "map";
inline constexpr const char* kCameraFrame = "camera";

// Writes a JPEG as sensor_msgs/CompressedImage, all else as sensor_msgs/Image with its pixels as they are.
std::string image_message(const image_t& image, Ros ros);
const char* type_of(const image_t& image);
std::string camera_info_message(const Camera& camera, int64_t utime_us, Ros ros);
std::string pose_message(const TimedPose& pose, Ros ros);
// Writes the pose as the transform of the camera's frame (tf).
std::string transforms_message(const TimedPose& pose, Ros ros);
std::string path_message(const std::vector<TimedPose>& poses, Ros ros);

}  // namespace rumi
