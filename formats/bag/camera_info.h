// SPDX-License-Identifier: BSD-3-Clause
// sensor_msgs/CameraInfo as a calibration file.
#pragma once

#include <string>

#include "formats/bag/ros_messages.h"

namespace rumi {

// As `ros2 topic echo` prints it, which parse_camera() reads and judges. `is_rectified`: of images that are undistorted
// already, whose camera is P.
std::string camera_info_text(const RosCameraInfo& info, bool is_rectified);
// False if all is zero, which is how ROS says that there is no calibration.
bool is_calibrated(const RosCameraInfo& info, bool is_rectified);
// What the drivers of the first Kinect say of a camera that nobody has calibrated.
bool is_nominal_kinect(const RosCameraInfo& info);
// By the topic's name: image_rect, image_rect_color.
bool is_rectified_topic(const std::string& topic);

}  // namespace rumi
