// SPDX-License-Identifier: BSD-3-Clause
// Camera calibration files: our flat YAML, and those of other tools (formats/camera/formats.h), told apart by
// their keys.
#pragma once

#include <string>
#include <vector>

#include "slam/geometry/camera.h"

namespace rumi {

struct CameraFileResult {
  Camera camera;
  std::string format;              // "rumi", "ROS camera_info", "Kalibr", "OpenCV", "ORB-SLAM3", ...
  std::string error;               // empty, or the name, field, value and what to do
  std::vector<std::string> notes;  // what of the file is not used, or was chosen: with its name, to be logged once
  std::string file;                // as it was given
  std::string mask;                // file that it names, empty if it names none; of a text always
  std::string name, lens;          // of the camera in a file of several: "Color 640x480" and "Color"

  struct Other {
    std::string name;
    std::string lens;  // the same as the chosen one's: the same camera in another size
    Camera camera;
  };
  std::vector<Other> others;  // further cameras of the file, which can be used

  bool ok() const { return error.empty(); }
};

// "FILE", or of a file of several cameras "FILE:NAME" (cam1). A file whose whole name that is goes before.
CameraFileResult read_camera_file(const std::string& file);
CameraFileResult parse_camera(const std::string& text, const std::string& name_for_errors);

// Where the file has the chosen camera in this size, too, this is taken.
void choose_size(int width, int height, CameraFileResult* result);
// What to do where images have another size than the calibration: "its cam1 is for this size: ...".
std::string advice_on_size(const CameraFileResult& calibration, int width, int height);
void log_notes(const CameraFileResult& result);

}  // namespace rumi
