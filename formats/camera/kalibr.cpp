// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "formats/camera/formats.h"
#include "formats/camera/lens.h"

namespace rumi {
namespace {

// Reads Kalibr's cam0 or EuRoC's sensor.yaml, which differ only in the name of the field with the coefficients.
Camera read_camera(Fields& in, const char* coefficients) {
  Camera camera;
  const std::string type = in.text("camera_model", "pinhole");
  if (type != "pinhole") return refuse_model(in, in.full("camera_model"), type, "pinhole"), camera;
  set_intrinsics(in.list("intrinsics", "fx, fy, cx, cy", 4), &camera);
  const std::vector<double> size = in.list("resolution", "width, height", 2);
  if (in.error()) return camera;
  for (size_t i = 0; i < 2; ++i)
    if (size[i] < 1 || size[i] > 1e6 || size[i] != static_cast<int>(size[i]))
      return in.fail(fmt::format("{}[{}] is '{:.6g}': must be a whole number of pixels", in.full("resolution"), i,
                                 size[i])),
             camera;
  camera.width = static_cast<int>(size[0]), camera.height = static_cast<int>(size[1]);
  const std::string model = in.text("distortion_model", "none");
  const std::vector<double> d =
      model != "none" || in.has(coefficients) ? in.list(coefficients, "k1, k2, p1, p2") : std::vector<double>();
  const std::string field = in.full(coefficients);
  if (model == "equidistant" || model == "equi") {
    set_fisheye(in, d, field, &camera);
  } else if (model == "radtan" || model == "radial-tangential" || model == "plumb_bob") {
    set_radial_tangential(in, d, field, &camera);
  } else if (model != "none") {
    refuse_model(in, in.full("distortion_model"), model, "radtan (radial-tangential), equidistant and none");
  } else if (std::any_of(d.begin(), d.end(), [](double value) { return value != 0; })) {
    in.fail(fmt::format("{} has values that are not 0, and {} is none or missing: write radtan or equidistant", field,
                        in.full("distortion_model")));
  }
  camera.fps = in.optional_number("rate_hz");
  in.pass_over({"cam_overlaps", "rostopic", "T_", "timeshift", "sensor_type", "comment", "line_delay", "label"});
  return camera;
}

}  // namespace

Result<FileCameras> read_kalibr(const Fields& in) {
  FileCameras all{"Kalibr", {}};
  std::vector<std::string> names;
  for (const std::string& name : in.names()) {
    const std::string camera = name.substr(0, name.find('.'));
    const bool is_camera =
        camera.starts_with("cam") && camera.size() > 3 && name.size() > camera.size() &&
        std::all_of(camera.begin() + 3, camera.end(), [](unsigned char c) { return std::isdigit(c); });
    if (is_camera && std::find(names.begin(), names.end(), camera) == names.end()) names.push_back(camera);
    if (names.size() > kMostCameras) return too_many_cameras(in);
  }
  std::sort(names.begin(), names.end());
  for (const std::string& name : names) {
    Fields fields = in.group(name + ".");
    const Camera camera = read_camera(fields, fields.has("distortion_coeffs") || !fields.has("distortion_coefficients")
                                                  ? "distortion_coeffs"
                                                  : "distortion_coefficients");
    all.cameras.push_back(file_camera(name, camera, fields));
  }
  return all;
}

Result<FileCameras> read_euroc(Fields in) {
  const Camera camera =
      read_camera(in, in.has("distortion_coefficients") || !in.has("distortion_coeffs") ? "distortion_coefficients"
                                                                                        : "distortion_coeffs");
  return FileCameras{"EuRoC", {file_camera("", camera, in)}};
}

}  // namespace rumi
