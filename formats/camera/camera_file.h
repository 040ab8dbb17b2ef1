// SPDX-License-Identifier: BSD-3-Clause
// Reads camera calibration files: our flat YAML, and those of other tools (formats/camera/formats.h), told apart by
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
  std::vector<std::string> notes;  // tell which parts of the file are not used, or which were chosen; to be logged once
  std::string file;                // name of the file, as the user gave it
  std::string mask;                // the mask that the file names; may be empty
  std::string name, lens;          // of the chosen camera, if the file has several: "Color 640x480", "Color"

  struct Other {
    std::string name;
    std::string lens;  // equal to that of the chosen camera: the same camera in another size
    Camera camera;
  };
  std::vector<Other> others;  // further cameras of the file, which can be used
};

// `file` is "FILE", or "FILE:NAME" for one camera of several (cam1); if a file has this whole name, that one is read.
// Errors name the file, the field, its value and what to do.
Result<CameraFile> read_camera_file(const std::string& file);
Result<CameraFile> parse_camera(const std::string& text, const std::string& name_for_errors);

// Changes to the chosen camera's calibration for this image size, if the file has one.
void choose_size(int width, int height, CameraFile* result);
// Tells what to do if images have another size than the calibration: "cam1 of the same file is for this size: ...".
std::string advice_on_size(const CameraFile& calibration, int width, int height);
void log_notes(const CameraFile& result);

}  // namespace rumi
