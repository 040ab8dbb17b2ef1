// SPDX-License-Identifier: BSD-3-Clause
// Reads the files of tools that calibrate cameras, or use calibrations. A reader is asked only for a file that has its
// format's keys.
#pragma once

#include <string>
#include <vector>

#include "bus/wire/yaml_fields.h"
#include "slam/geometry/camera.h"

namespace rumi {

// One camera of a file, for one size of its images.
struct FileCamera {
  std::string name;       // "cam1", "Color 640x480"; empty in a file of one camera
  std::string lens;       // "cam1", "Color"; one name for all sizes of a camera
  Result<Camera> camera;  // an Error says why this camera cannot be used
  std::vector<std::string> notes = {};
  std::string mask = {};  // the mask's file that the calibration names; may be empty
};

struct FileCameras {
  std::string format;
  std::vector<FileCamera> cameras;  // the default camera first
};

// Largest number of cameras in a file that has a group for each.
inline constexpr size_t kMostCameras = 64;
Error too_many_cameras(const Fields& in);

// Returns the camera that a reader found, or the error that `in` has kept.
FileCamera file_camera(const std::string& name, const Camera& camera, Fields& in);

Result<FileCameras> read_rumi(const Fields& in);
Result<FileCameras> read_ros(Fields in);             // camera_info as calibration programs write it
Result<FileCameras> read_ros_message(Fields in);     // camera_info as `ros2 topic echo` and `rostopic echo` print it
Result<FileCameras> read_opencv(Fields in);          // FileStorage
Result<FileCameras> read_kalibr(const Fields& in);   // camchain: cam0, cam1, ...
Result<FileCameras> read_euroc(Fields in);           // sensor.yaml
Result<FileCameras> read_orbslam(const Fields& in);  // ORB-SLAM2 and 3, OpenVSLAM, stella_vslam: "Camera.fx"
Result<FileCameras> read_basalt(const Fields& in);
Result<FileCameras> read_camodocal(Fields in);  // VINS's cameras, too
Result<FileCameras> read_depthai(const Fields& in);
Result<FileCameras> read_nerf(Fields in);      // transforms.json
Result<FileCameras> read_gyroflow(Fields in);  // lens profiles, of GoPro and others

bool is_realsense_listing(const std::string& text);
Result<FileCameras> read_realsense(const std::string& text, const std::string& file);
bool is_colmap_list(const std::string& text);
Result<FileCameras> read_colmap(const std::string& text, const std::string& file);
bool is_nerf_list(const std::string& text);  // transforms.json with the poses of all images
Result<FileCameras> read_nerf_list(const std::string& text, const std::string& file);

// Chooses the reader by the file's keys. The Error for a format that is not read names the tool that writes it, if the
// keys tell.
Result<FileCameras> read_fields(const Fields& in);
// Names the format of a text that is no YAML, or of a file that is no text, and what to do. Empty if it is not known.
std::string known_stranger(const std::string& text);
// As known_stranger(), but only for DSO's camera.txt.
std::string known_dso(const std::string& text);
// Turns OpenCV's FileStorage in XML into YAML; empty if the text is no such XML. Used for files only, not for texts
// from the network.
std::string yaml_of_opencv_xml(const std::string& xml);

}  // namespace rumi
