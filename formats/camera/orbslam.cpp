// SPDX-License-Identifier: BSD-3-Clause
// Reads camera files of ORB-SLAM2 and 3 ("Camera.fx", since ORB-SLAM3 1.0 "Camera1.fx"), OpenVSLAM ("Camera.fx" with
// Camera.cols) and stella_vslam (as OpenVSLAM, but in a group "Camera").
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "formats/camera/formats.h"
#include "formats/camera/lens.h"

namespace rumi {
namespace {

enum class Lens { kPinhole, kFisheye, kRectified, kRefused };

constexpr const char* kModels = "perspective and fisheye";
constexpr const char* kTypes = "PinHole, KannalaBrandt8 and Rectified";

Lens lens_of(Fields& in, const std::string& key, const char* supported) {
  const std::string name = lower_case(in.text(key, "pinhole"));
  if (name == "perspective" || name == "pinhole") return Lens::kPinhole;
  if (name == "fisheye" || name == "kannalabrandt8" || name == "kannalabrandt" || name == "kannala_brandt")
    return Lens::kFisheye;
  if (name == "rectified") return Lens::kRectified;
  refuse_model(in, key, in.text(key, ""), supported);
  return Lens::kRefused;
}

Lens read_lens_name(Fields& in) {
  const Lens type = lens_of(in, "Camera.type", kTypes);
  if (!in.has("Camera.model")) return type;
  const Lens model = lens_of(in, "Camera.model", kModels);
  if (in.has("Camera.type") && !in.error() && model != type)
    in.fail(fmt::format("Camera.model is {} and Camera.type is {}: remove the one that is wrong",
                        in.quoted("Camera.model"), in.quoted("Camera.type")));
  return model;
}

int read_side(Fields& in, const char* ours, const char* other) {
  const std::string key = in.spelling({ours, other});
  const int side = in.size(key);
  if (in.has(ours) && in.has(other) && in.size(other) != side)
    in.fail(
        fmt::format("{} is {} and {} is {}: which of them is right?", ours, in.quoted(ours), other, in.quoted(other)));
  return side;
}

// Returns the key of the matrix that some versions have instead of k1, k2, ...; empty if there is none.
std::string coefficient_list(const Fields& in, const std::string& prefix) {
  for (const std::string& key : {std::string("DistCoef"), prefix + "DistCoef", prefix + "D"})
    for (const std::string& spelled : {key, key + ".data"})
      if (in.has(spelled)) return spelled;
  return "";
}

std::vector<double> coefficients(Fields& in, const std::string& prefix, std::initializer_list<const char*> keys) {
  std::vector<double> d;
  for (const char* key : keys) d.push_back(in.optional_number(prefix + key));
  return d;
}

void tell_what_rectified_leaves_out(Fields& in, const std::string& prefix) {
  std::vector<std::string> given;
  for (const char* key : {"k1", "k2", "k3", "k4", "p1", "p2"})
    if (const double value = in.optional_number(prefix + key); value != 0)
      given.push_back(fmt::format("{}{} ({:.6g})", prefix, key, value));
  if (!given.empty())
    in.note(
        fmt::format("Camera.type is Rectified, so {} are not used: the images must be rectified; if they are as the "
                    "camera gives them, write Camera.type: \"PinHole\"",
                    fmt::join(given, ", ")));
}

void refuse_rational(Fields& in, const std::string& prefix) {
  const bool is_rational = in.optional_number(prefix + "k5") != 0 || in.optional_number(prefix + "k6") != 0;
  for (const char* key : {"k4", "k5", "k6"}) {
    const double value = in.optional_number(prefix + key);
    if (value == 0) continue;
    in.fail(is_rational
                ? fmt::format("{}{} is {:.6g}: the rational model (k4 k5 k6) is not supported; calibrate again with k1 "
                              "k2 p1 p2 k3 only, or rectify the images and give the rectified camera",
                              prefix, key, value)
                : fmt::format("{}{} is {:.6g}, which a perspective camera (PinHole) has not: if it is of a fisheye, "
                              "write its model (Camera.model: \"fisheye\", Camera.type: \"KannalaBrandt8\"); the "
                              "rational model, with k4 k5 k6, is not supported",
                              prefix, key, value));
  }
}

void read_coefficients(Fields& in, Lens lens, const std::string& prefix, Camera* camera) {
  const std::string list = coefficient_list(in, prefix);
  const std::string field = list.empty() ? prefix + "k1 ..." : list;
  if (lens == Lens::kRectified) {
    tell_what_rectified_leaves_out(in, prefix);
  } else if (!list.empty()) {
    const std::vector<double> d = in.list(list, "k1, k2, p1, p2, k3");
    lens == Lens::kFisheye ? set_fisheye(in, d, field, camera) : set_radial_tangential(in, d, field, camera);
  } else if (lens == Lens::kFisheye) {
    set_fisheye(in, coefficients(in, prefix, {"k1", "k2", "k3", "k4"}), field, camera);
  } else {
    set_radial_tangential(in, coefficients(in, prefix, {"k1", "k2", "p1", "p2", "k3"}), field, camera);
    refuse_rational(in, prefix);
    if (const double value = in.optional_number("Camera.bFishEye"); value != 0)
      in.fail(fmt::format("Camera.bFishEye is {:.6g}: for a fisheye write Camera.type: \"KannalaBrandt8\"", value));
  }
}

Camera read_camera(Fields& in, const std::string& prefix) {
  Camera camera;
  const Lens lens = read_lens_name(in);
  if (lens == Lens::kRefused || in.error()) return camera;
  camera.width = read_side(in, "Camera.width", "Camera.cols");
  camera.height = read_side(in, "Camera.height", "Camera.rows");
  const std::pair<const char*, double*> required[] = {
      {"fx", &camera.fx}, {"fy", &camera.fy}, {"cx", &camera.cx}, {"cy", &camera.cy}};
  for (const auto& [key, value] : required) *value = in.number(prefix + key, "pixels");
  read_coefficients(in, lens, prefix, &camera);
  camera.fps = in.optional_number("Camera.fps");
  for (const char* key : {"Camera.newWidth", "Camera.newHeight", "Camera.newImageWidth", "Camera.newImageHeight"})
    if (in.has(key) && in.number(key, "pixels") != (std::string(key).ends_with("Width") ? camera.width : camera.height))
      in.note(fmt::format("{} is {}, which is not used: give the images in the size of Camera.width and Camera.height",
                          key, in.quoted(key)));
  if (const double scale = in.optional_number("Camera.imageScale"); scale != 0 && scale != 1)
    in.note(
        fmt::format("Camera.imageScale is {:.6g}, which is not used: give the images in the calibrated size", scale));
  return camera;
}

// Skips keys of the SLAM program, of stereo cameras, IMUs and depth images.
void pass_over_the_rest(Fields& in) {
  in.pass_over({"File.",
                "System.",
                "ORBextractor.",
                "Viewer.",
                "Feature.",
                "Tracking.",
                "Mapping.",
                "Initializer.",
                "Preprocessing.",
                "PangolinViewer.",
                "SocketPublisher.",
                "LoopDetector.",
                "GlobalOptimizer.",
                "Relocalizer.",
                "KeyframeInserter.",
                "MapDatabase.",
                "StereoRectifier.model",
                "Marker",
                "IMU.",
                "Tbc",
                "Stereo.",
                "RGBD.",
                "ThDepth",
                "DepthMapFactor",
                "DEPTH",
                "loopClosing",
                "thFarPoints"});
  in.pass_over({"Camera.name", "Camera.setup", "Camera.color_order", "Camera.RGB", "Camera.bf", "Camera.bFishEye",
                "Camera.focal_x_baseline", "Camera.depth_threshold", "Camera.lappingBegin", "Camera.lappingEnd",
                "Camera1.overlapping", "Camera2.overlapping", "depth_threshold", "depthmap_factor"});
}

}  // namespace

Result<FileCameras> read_orbslam(const Fields& in) {
  const bool is_stella = in.has("Camera.model") || in.has("Camera.cols");
  FileCameras all{is_stella ? "OpenVSLAM" : "ORB-SLAM3", {}};
  const bool has_two = in.has("Camera2.fx") && in.has("Camera1.fx");
  for (const char* name : {"Camera1", "Camera2"}) {
    Fields fields = in;
    if (has_two) fields.pass_over({std::string(name) == "Camera1" ? "Camera2." : "Camera1."});
    const std::string prefix = in.has("Camera1.fx") ? std::string(name) + "." : "Camera.";
    const Camera camera = read_camera(fields, prefix);
    pass_over_the_rest(fields);
    all.cameras.push_back(file_camera(has_two ? name : "", camera, fields));
    if (!has_two) break;
  }
  return all;
}

}  // namespace rumi
