// SPDX-License-Identifier: BSD-3-Clause
#include "formats/camera/formats.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <sstream>

namespace rumi {
namespace {

constexpr const char* kWriteOwn =
    "write its numbers as fx, fy, cx, cy, k1, k2, p1, p2, k3, width, height (docs/calibration.md)";

struct Stranger {
  const char* sign;  // the beginning of a key
  std::string what;
};

const std::vector<Stranger>& strangers_by_key() {
  static const std::vector<Stranger> kStrangers = {
      {"P_rect_",
       "is KITTI's calib_cam_to_cam.txt: give P_rect_00's values 1, 6, 3 and 7 as fx, fy, cx, cy, and S_rect_00 "
       "as width and height"},
      {"S_00", "is KITTI's calib_cam_to_cam.txt, of which nothing is read"},
      {"cameras[0].camera.", "is a file of SVO or ROVIO"},
      {"cameras[0].", "is a file of OKVIS, or of a like program"},
      {"cam_model", "is a file of SVO or of REMODE"},
      {"cam0_calib", "names the cameras' files and is none: give the file that cam0_calib names"},
      {"M1",
       "is a stereo calibration of OpenCV, which has no size of the images: name M1 camera_matrix and D1 "
       "distortion_coefficients, and add image_width and image_height"},
      {"K1",
       "is a stereo calibration, with K1 and D1: name them camera_matrix and distortion_coefficients, and add "
       "image_width and image_height"},
      {"intrinsic_parameters", "is a calibration of a kind that is not known"},
      {"lens_properties", "is a calibration of a kind that is not known"},
  };
  return kStrangers;
}

Error refuse(const Fields& in, const std::string& what) {
  const bool says_what_to_do = what.find(':') != std::string::npos;
  if (says_what_to_do) return {what, in.file()};
  return {fmt::format("{}, which is not read: {}", what, kWriteOwn), in.file()};
}

// Refuses KITTI's calib.txt: it has P0 to P3, the twelve numbers of a projection each, and no size of the images.
Error refuse_kitti(Fields in) {
  std::istringstream text(in.text("P0", ""));
  double p[12] = {};
  for (double& value : p) text >> value;
  return refuse(in,
                fmt::format("is KITTI's calib.txt, which has no size of the images: for its camera 0 write fx: {:.7g}, "
                            "fy: {:.7g}, cx: {:.7g}, cy: {:.7g}, width: <pixels>, height: <pixels>",
                            p[0], p[5], p[2], p[6]));
}

Result<FileCameras> read_one(const Fields& in);

// Reads a file with a group for each camera: camera0: {camera_matrix: ...}. Returns no cameras if the file has no such
// groups.
Result<FileCameras> read_groups(const Fields& in) {
  FileCameras all;
  for (const std::string& name : in.names()) {
    const std::string group = name.substr(0, name.find('.'));
    const bool is_known = std::any_of(all.cameras.begin(), all.cameras.end(),
                                      [&group](const FileCamera& camera) { return camera.name == group; });
    if (is_known || group == name || !in.has_any(group + ".camera_matrix")) continue;
    if (all.cameras.size() >= kMostCameras) return too_many_cameras(in);
    Result<FileCameras> one = read_one(in.group(group + "."));
    if (!one) continue;
    all.format = one->format;
    for (FileCamera& camera : one->cameras) {
      camera.name = camera.lens = group;
      all.cameras.push_back(std::move(camera));
    }
  }
  return all;
}

Error refuse_unknown(const Fields& in) {
  if (in.has("P0")) return refuse_kitti(in);
  for (const Stranger& stranger : strangers_by_key())
    if (in.has_any(stranger.sign)) return refuse(in, stranger.what);
  std::vector<std::string> names;
  for (const std::string& name : in.names()) {
    const std::string top = name.substr(0, std::min<size_t>(name.find_first_of(".["), 40));
    if (std::find(names.begin(), names.end(), top) == names.end()) names.push_back(top);
  }
  names.resize(std::min<size_t>(names.size(), 6));
  return refuse(in, fmt::format("has no keys of a calibration that are known (it has {}): {}", fmt::join(names, ", "),
                                kWriteOwn));
}

bool has_one_of(const Fields& in, std::initializer_list<const char*> keys) {
  return std::any_of(keys.begin(), keys.end(),
                     [&in](const char* key) { return in.has(key) || in.has_any(std::string(key) + "."); });
}

bool has_kalibr_camera(const Fields& in) {
  for (int i = 0; i < 10; ++i)
    for (const char* key : {"intrinsics", "camera_model", "resolution"})
      if (in.has(fmt::format("cam{}.{}", i, key))) return true;
  return false;
}

Result<FileCameras> read_one(const Fields& in) {
  if (in.has_any("Camera.") || in.has_any("Camera1.")) return read_orbslam(in);
  // FileStorage's matrices have an element type; ROS's have rows and columns and no type.
  const bool is_ros = in.has("camera_matrix.data") && !in.has("camera_matrix.dt");
  if (is_ros && in.has_any("distortion_coefficients")) return read_ros(in);
  if (has_one_of(in, {"camera_matrix", "Camera_Matrix", "cameraMatrix", "CameraMatrix", "intrinsic_matrix", "mtx"}))
    return read_opencv(in);
  if ((in.has("k") || in.has("K")) && in.has("height")) return read_ros_message(in);
  if (in.has("model_type")) return read_camodocal(in);
  if (has_kalibr_camera(in)) return read_kalibr(in);
  if (in.has_any("value0.intrinsics[")) return read_basalt(in);
  if (in.has_any("cameraData[")) return read_depthai(in);
  if (in.has("intrinsics")) return read_euroc(in);
  if (in.has("fl_x") || in.has("camera_angle_x")) return read_nerf(in);
  if (has_one_of(in, {"model", "fx", "fy", "cx", "cy", "fps"})) return read_rumi(in);
  return refuse_unknown(in);
}

}  // namespace

Error too_many_cameras(const Fields& in) {
  return {fmt::format("has more than {} cameras: keep the one that you use", kMostCameras), in.file()};
}

Result<FileCameras> read_fields(const Fields& in) {
  if (in.error()) return *in.error();
  if (in.has("fisheye_params.camera_matrix")) return read_gyroflow(in);
  Result<FileCameras> groups = read_groups(in);
  return groups && groups->cameras.empty() ? read_one(in) : groups;
}

std::string known_stranger(const std::string& text) {
  if (text.find_first_not_of(" \t\r\n") == std::string::npos) return {};
  const std::string own = kWriteOwn;
  const auto begins = [&text](const char* sign) { return text.starts_with(sign); };
  const auto holds = [&text](const char* sign) { return text.find(sign) != std::string::npos; };
  if (begins("\xFF\xFE") || begins("\xFE\xFF")) return "is UTF-16 (as PowerShell writes it): save it as UTF-8";
  if (begins("PK")) return "is an archive, or NumPy's .npz: " + own;
  if (begins("\x93NUMPY")) return "is a file of NumPy: " + own;
  if (begins("MATLAB 5.0")) return "is a file of MATLAB: " + own;
  if (begins("%PDF")) return "is a PDF: give the YAML file that was made with it";
  if (holds("# oST version") || holds("[narrow_stereo")) return "is ROS's ost.txt: give the ost.yaml made with it";
  if (holds("[LEFT_CAM"))
    return "is a file of a ZED camera, which is not read: take the numbers below the [LEFT_CAM...] of your size; " +
           own;
  if (holds("projection:") && holds("+-")) return "is Kalibr's text of results: give the camchain YAML made with it";
  if (const std::string dso = known_dso(text); !dso.empty()) return dso;
  if (text.find_first_not_of("0123456789.+-eE,;[]() \t\r\n") == std::string::npos)
    return "has numbers without names, and no size of the images: " + own;
  const size_t first = text.find_first_not_of(" \t\r\n");
  if (first != std::string::npos && text[first] == '<')
    return "is XML of a kind that is not read (of OpenCV's FileStorage it would be): " + own;
  return "";
}

}  // namespace rumi
