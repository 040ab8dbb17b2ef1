// SPDX-License-Identifier: BSD-3-Clause
// The files of the tools that calibrate cameras, or use calibrations. A reader is asked only for a file that has its
// format's keys.
#pragma once

#include <string>
#include <vector>

#include "bus/wire/yaml_fields.h"
#include "slam/geometry/camera.h"

namespace rumi {

// One camera of a file, in one size of its images.
struct FileCamera {
  std::string name;  // "cam1", "Color 640x480"; empty in a file of one camera
  std::string lens;  // the same for the sizes of one camera: "cam1", "Color"
  Camera camera;
  std::string error;  // empty, or why this one cannot be used
  std::vector<std::string> notes;
  std::string mask = {};  // the file that it names
};

struct FileCameras {
  std::string format;
  std::vector<FileCamera> cameras;  // that one first which is meant if nothing else is said
  std::string error;                // of the whole file
};

// Of a file that has each as a group of its own.
inline constexpr size_t kMostCameras = 64;
FileCameras too_many_cameras(const Fields& in);

// What a reader of one camera found.
FileCamera file_camera(const std::string& name, const Camera& camera, Fields& in);

FileCameras read_rumi(const Fields& in);
FileCameras read_ros(Fields in);             // camera_info as calibration programs write it
FileCameras read_ros_message(Fields in);     // camera_info as `ros2 topic echo` and `rostopic echo` print it
FileCameras read_opencv(Fields in);          // FileStorage
FileCameras read_kalibr(const Fields& in);   // camchain: cam0, cam1, ...
FileCameras read_euroc(Fields in);           // sensor.yaml
FileCameras read_orbslam(const Fields& in);  // ORB-SLAM2 and 3, OpenVSLAM, stella_vslam: "Camera.fx"
FileCameras read_basalt(const Fields& in);
FileCameras read_camodocal(Fields in);  // VINS's cameras, too
FileCameras read_depthai(const Fields& in);
FileCameras read_nerf(Fields in);      // transforms.json
FileCameras read_gyroflow(Fields in);  // lens profiles, of GoPro and others

bool is_realsense_listing(const std::string& text);
FileCameras read_realsense(const std::string& text, const std::string& file);
bool is_colmap_list(const std::string& text);
FileCameras read_colmap(const std::string& text, const std::string& file);
bool is_nerf_list(const std::string& text);  // with the poses of all images
FileCameras read_nerf_list(const std::string& text, const std::string& file);

// By its keys. What cannot be read is refused by the name of the tool that writes it, where that is known.
FileCameras read_fields(const Fields& in);
// What a text that is no YAML, or a file that is no text, is known to be: with what to do. Empty if not known.
std::string known_stranger(const std::string& text);
// The same for DSO's camera.txt.
std::string known_dso(const std::string& text);
// OpenCV's FileStorage in XML, as YAML; empty if it is none. For files, not for what comes from the network.
std::string yaml_of_opencv_xml(const std::string& xml);

}  // namespace rumi
