// SPDX-License-Identifier: BSD-3-Clause
// Reads camera files of Basalt, camodocal (VINS-Mono, VINS-Fusion) and DepthAI.
#include <fmt/format.h>

#include "formats/camera/formats.h"
#include "formats/camera/lens.h"

namespace rumi {
namespace {

constexpr int kMostSockets = 16;

void read_intrinsics(Fields& in, const std::string& prefix, Camera* camera) {
  set_intrinsics({in.number(prefix + "fx", "pixels"), in.number(prefix + "fy", "pixels"),
                  in.number(prefix + "cx", "pixels"), in.number(prefix + "cy", "pixels")},
                 camera);
}

std::vector<double> coefficients(Fields& in, const std::string& prefix, std::initializer_list<const char*> keys) {
  std::vector<double> d;
  for (const char* key : keys) d.push_back(in.optional_number(prefix + key));
  return d;
}

Camera read_basalt_camera(Fields& in, int index) {
  Camera camera;
  const std::string prefix = fmt::format("intrinsics[{}].", index), lens = prefix + "intrinsics.";
  const std::vector<double> sizes = in.list("resolution", "[width, height] of each camera");
  if (sizes.size() < 2 * static_cast<size_t>(index) + 2) in.fail("value0.resolution has no size of this camera");
  if (in.error()) return camera;
  for (const double side : {sizes[2 * index], sizes[2 * index + 1]})
    if (!(side >= 0 && side <= 1e6)) return in.fail("value0.resolution: must be numbers of pixels"), camera;
  camera.width = static_cast<int>(sizes[2 * index]), camera.height = static_cast<int>(sizes[2 * index + 1]);
  const std::string type = in.text(prefix + "camera_type", "");
  if (type != "kb4" && !type.starts_with("pinhole"))
    return refuse_model(in, in.full(prefix + "camera_type"), type, "pinhole, pinhole-radtan8 and kb4"), camera;
  read_intrinsics(in, lens, &camera);
  if (type == "kb4")
    set_fisheye(in, coefficients(in, lens, {"k1", "k2", "k3", "k4"}), lens + "k1 ...", &camera);
  else
    set_radial_tangential(in, coefficients(in, lens, {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"}), lens + "k1 ...",
                          &camera);
  return camera;
}

Camera read_depthai_camera(Fields& in) {
  Camera camera;
  camera.width = in.size("width"), camera.height = in.size("height");
  read_matrix(in, "intrinsicMatrix", &camera);
  const std::vector<double> d = in.list("distortionCoeff", "k1, k2, p1, p2, k3");
  const std::string field = in.full("distortionCoeff");
  const bool fisheye = in.optional_number("cameraType") == 1;
  if (!fisheye) return set_radial_tangential(in, d, field, &camera), camera;
  set_fisheye(in, {d.begin(), d.begin() + static_cast<std::ptrdiff_t>(std::min<size_t>(d.size(), 4))}, field, &camera);
  return camera;
}

}  // namespace

Result<FileCameras> read_basalt(const Fields& in) {
  FileCameras all{"Basalt", {}};
  for (int i = 0; i < kMostSockets && in.has_any(fmt::format("value0.intrinsics[{}].", i)); ++i) {
    Fields fields = in.group("value0.");
    const Camera camera = read_basalt_camera(fields, i);
    for (int other = 0; other < kMostSockets; ++other)
      if (other != i) fields.pass_over({fmt::format("intrinsics[{}].", other).c_str()});
    all.cameras.push_back(file_camera(fmt::format("cam{}", i), camera, fields));
    all.cameras.back().notes.clear();  // they only name vignettes, the IMU and the other cameras
  }
  return all;
}

Result<FileCameras> read_camodocal(Fields in) {
  Camera camera;
  camera.width = in.size("image_width"), camera.height = in.size("image_height");
  const std::string model = in.text("model_type", ""), p = "projection_parameters.", d = "distortion_parameters.";
  if (model == "PINHOLE") {
    read_intrinsics(in, p, &camera);
    set_radial_tangential(in, coefficients(in, d, {"k1", "k2", "p1", "p2"}), "distortion_parameters", &camera);
  } else if (model == "KANNALA_BRANDT") {
    set_intrinsics({in.number(p + "mu", "pixels"), in.number(p + "mv", "pixels"), in.number(p + "u0", "pixels"),
                    in.number(p + "v0", "pixels")},
                   &camera);
    // camodocal counts coefficients from k1, which is always 1: its k2 is our k1.
    set_fisheye(in, coefficients(in, p, {"k2", "k3", "k4", "k5"}), "projection_parameters", &camera);
  } else {
    refuse_model(in, "model_type", model, "PINHOLE and KANNALA_BRANDT");
  }
  in.pass_over({"camera_name",
                "imu",
                "image_topic",
                "output_path",
                "acc_",
                "gyr_",
                "g_norm",
                "extrinsic",
                "estimate_extrinsic",
                "max_",
                "min_dist",
                "freq",
                "F_threshold",
                "show_track",
                "equalize",
                "fisheye_mask",
                "keyframe_parallax",
                "loop_closure",
                "load_previous",
                "fast_relocalization",
                "pose_graph",
                "estimate_td",
                "td",
                "rolling_shutter",
                "visualize",
                "save_image",
                "fisheye"});
  return FileCameras{"camodocal", {file_camera("", camera, in)}};
}

Result<FileCameras> read_depthai(const Fields& in) {
  FileCameras all{"DepthAI", {}};
  for (int i = 0; i < kMostSockets; ++i) {
    const std::string prefix = fmt::format("cameraData[{}][1].", i);
    if (!in.has(prefix + "intrinsicMatrix")) continue;
    Fields fields = in;
    const double socket = fields.optional_number(fmt::format("cameraData[{}][0]", i));
    fields = in.group(prefix);
    const Camera camera = read_depthai_camera(fields);
    const bool is_letter = socket >= 0 && socket < 26;
    all.cameras.push_back(file_camera(
        is_letter ? fmt::format("CAM_{}", static_cast<char>('A' + static_cast<int>(socket))) : "CAM", camera, fields));
    all.cameras.back().notes.clear();  // they only name the camera's place among the others
  }
  return all;
}

}  // namespace rumi
