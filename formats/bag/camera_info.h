// SPDX-License-Identifier: BSD-3-Clause
// Turns a sensor_msgs/CameraInfo into a calibration file.
#pragma once

#include <string>

#include "formats/bag/ros_messages.h"

namespace rumi {

// Writes the message as `ros2 topic echo` prints it; parse_camera() reads and judges that. `is_rectified`: the images
// are undistorted already, and P is their camera.
std::string camera_info_text(const RosCameraInfo& info, bool is_rectified);
// False if the camera matrix (P for undistorted images, else K) is all zero, which is how ROS says that there is no
// calibration.
bool is_calibrated(const RosCameraInfo& info, bool is_rectified);
// True for the values that the first Kinect's drivers give for a camera that nobody has calibrated.
bool is_nominal_kinect(const RosCameraInfo& info);
// True if the topic's name says that its images are undistorted: image_rect, image_rect_color.
bool is_rectified_topic(const std::string& topic);

}  // namespace rumi
