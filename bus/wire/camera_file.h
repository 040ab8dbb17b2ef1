// SPDX-License-Identifier: BSD-3-Clause
// Camera calibration files: our flat YAML, and those of ROS camera_info, Kalibr, OpenCV and ORB-SLAM3, told apart by
// their keys.
#pragma once

#include <string>
#include <variant>

#include "slam/geometry/camera.h"

namespace rumi {

struct CameraFileResult {
  Camera camera;
  std::string format;  // "rumi", "ROS camera_info", "Kalibr", "OpenCV", "ORB-SLAM3"
  std::string error;   // empty, or the name, field, value and what to do
  bool ok() const { return error.empty(); }
};

CameraFileResult read_camera_file(const std::string& file);
CameraFileResult parse_camera(const std::string& yaml_text, const std::string& name_for_errors);

// Our own format, which parse_camera reads back without loss.
std::string camera_to_yaml(const Camera& camera);

}  // namespace rumi
