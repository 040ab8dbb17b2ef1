// SPDX-License-Identifier: BSD-3-Clause
// Reads transforms.json of nerfstudio, instant-ngp and their likes: one camera, and a pose for each image. The poses
// are not used.
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "base/text/json_text.h"
#include "formats/camera/formats.h"
#include "formats/camera/lens.h"

namespace rumi {
namespace {

using nlohmann::json;

bool has_camera(const json& object) {
  return object.is_object() && (object.contains("fl_x") || object.contains("camera_angle_x"));
}

// Returns the fields of a frame that describe its camera: all but those of its own image and pose.
json camera_of(json frame) {
  for (const char* key :
       {"file_path", "transform_matrix", "depth_file_path", "mask_path", "semantic_path", "sharpness", "colmap_im_id"})
    if (frame.is_object()) frame.erase(key);
  return frame;
}

// Reads fl_x, or computes it from an angle of view.
double focal_length(Fields& in, const char* key, const char* angle, int pixels) {
  if (in.has(key) || !in.has(angle)) return in.number(key, "pixels");
  return 0.5 * pixels / std::tan(0.5 * in.number(angle, "radians"));
}

// Reads cx or cy. Both count from the corner of the first pixel, as in COLMAP; in Rumi they count from its centre.
double centre(Fields& in, const char* key, int pixels) {
  if (in.has(key)) return in.number(key, "pixels") - 0.5;
  in.note(fmt::format("{} is not there: the middle of the image is taken", key));
  return 0.5 * pixels - 0.5;
}

void refuse_without_size(Fields& in) {
  if (in.has("fl_x")) return in.fail("w and h, the size of the images in pixels, are missing: add them");
  const double ratio = 0.5 / std::tan(0.5 * in.number("camera_angle_x", "radians"));
  in.fail(fmt::format(
      "has the angle of view camera_angle_x, and no size of the images: add w and h, their width and height "
      "in pixels (fx and fy are {:.6g} times the width then)",
      ratio));
}

}  // namespace

bool is_nerf_list(const std::string& text) {
  const size_t first = text.find_first_not_of(" \t\r\n");
  const auto holds = [&text](const char* key) { return text.find(key) != std::string::npos; };
  return first != std::string::npos && text[first] == '{' && holds("\"frames\"") &&
         (holds("\"fl_x\"") || holds("\"camera_angle_x\""));
}

Result<FileCameras> read_nerf_list(const std::string& text, const std::string& file) {
  // Deeply nested values would be copied and written recursively.
  constexpr int kDeepest = 8;
  const auto is_shallow = [](int depth, json::parse_event_t, const json&) { return depth <= kDeepest; };
  json root = json::parse(text, is_shallow, /*allow_exceptions=*/false);
  const auto refuse = [&file](const std::string& why) { return Error{why, file}; };
  if (!root.is_object()) return refuse("is a transforms.json that is no correct JSON: is it cut off?");
  const json frames = root.value("frames", json::array());
  root.erase("frames");
  if (!has_camera(root) && frames.is_array() && !frames.empty()) {
    const json first = camera_of(frames[0]);
    for (const json& frame : frames)
      if (camera_of(frame) != first)
        return refuse(
            "has a camera for each image, and they differ: put that of your images at the top (fl_x, fl_y, cx, cy, w, "
            "h, k1, k2, p1, p2)");
    if (first.is_object()) root.update(first);
  }
  return read_nerf(Fields(load_yaml(json_text(root, 1)), file));
}

Result<FileCameras> read_nerf(Fields in) {
  Camera camera;
  if (!in.has("w") || !in.has("h")) {
    refuse_without_size(in);
    return FileCameras{"transforms.json", {file_camera("", camera, in)}};
  }
  camera.width = in.size("w"), camera.height = in.size("h");
  camera.fx = camera.fy = focal_length(in, "fl_x", "camera_angle_x", camera.width);
  if (in.has("fl_y") || in.has("camera_angle_y")) camera.fy = focal_length(in, "fl_y", "camera_angle_y", camera.height);
  camera.cx = centre(in, "cx", camera.width), camera.cy = centre(in, "cy", camera.height);
  std::string model = in.text("camera_model", "OPENCV");
  if (in.text("is_fisheye", "false") == "true") model = "OPENCV_FISHEYE";
  std::vector<double> d;
  if (model == "OPENCV_FISHEYE") {
    for (const char* key : {"k1", "k2", "k3", "k4"}) d.push_back(in.optional_number(key));
    set_fisheye(in, d, "k1 ...", &camera);
  } else if (model == "OPENCV" || model == "PINHOLE" || model.starts_with("SIMPLE_") || model == "RADIAL") {
    for (const char* key : {"k1", "k2", "p1", "p2", "k3"}) d.push_back(in.optional_number(key));
    set_radial_tangential(in, d, "k1 ...", &camera);
  } else {
    refuse_model(in, "camera_model", model, "OPENCV, PINHOLE and OPENCV_FISHEYE");
  }
  in.pass_over({"frames", "aabb_scale", "scale", "offset", "applied_", "orientation_override", "camera_angle",
                "ply_file_path", "train_filenames", "test_filenames", "val_filenames", "integer_depth_scale",
                "enable_depth", "is_fisheye", "up", "centroid", "totp"});
  return FileCameras{"transforms.json", {file_camera("", camera, in)}};
}

}  // namespace rumi
