// SPDX-License-Identifier: BSD-3-Clause
// Camera calibration files: our flat YAML, and those of other tools (formats/camera/formats.h), told apart by
// their keys.
#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "slam/geometry/camera.h"

namespace rumi {

struct CameraFile {
  Camera camera;
  std::string format;              // "rumi", "ROS camera_info", "Kalibr", "OpenCV", "ORB-SLAM3", ...
  std::vector<std::string> notes;  // which parts of the file are not used, or were chosen; to be logged once
  std::string file;                // as it was given
  std::string mask;                // the mask that the file names; may be empty
  std::string name, lens;          // of the chosen camera, if the file has several: "Color 640x480", "Color"

  struct Other {
    std::string name;
    std::string lens;  // the same as the chosen one's: the same camera in another size
    Camera camera;
  };
  std::vector<Other> others;  // further cameras of the file, which can be used
};

// `file` is "FILE", or "FILE:NAME" for one camera of several (cam1); a file of this whole name comes first. Errors name
// the file, the field, its value and what to do.
Result<CameraFile> read_camera_file(const std::string& file);
Result<CameraFile> parse_camera(const std::string& text, const std::string& name_for_errors);

// Takes the calibration of the chosen camera for this size, if the file has one.
void choose_size(int width, int height, CameraFile* result);
// Tells what to do if images have another size than the calibration: "its cam1 is for this size: ...".
std::string advice_on_size(const CameraFile& calibration, int width, int height);
void log_notes(const CameraFile& result);

}  // namespace rumi
