// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include "formats/camera/formats.h"
#include "formats/camera/lens.h"

namespace rumi {
namespace {

void set_lens(Fields& in, const std::string& key, Camera* camera) {
  const std::string model = in.text("distortion_model", "plumb_bob");
  const std::string field = in.full(key);
  const std::vector<double> d = in.list(key, "k1, k2, p1, p2, k3");
  if (model == "equidistant" || model == "fisheye") return set_fisheye(in, d, field, camera);
  const bool has_none = (model.empty() || model == "none") && d.empty();
  if (has_none || model == "plumb_bob" || model == "rational_polynomial")
    return set_radial_tangential(in, d, field, camera);
  refuse_model(in, "distortion_model", model, "plumb_bob, equidistant and rational_polynomial with k4 = k5 = k6 = 0");
}

// Fails if the images are only a part of the calibrated ones: the matrix of a message is always that of the whole
// image.
void refuse_parts_of_the_image(Fields& in, const Camera& camera) {
  for (const char* key : {"binning_x", "binning_y"})
    if (const double binning = in.optional_number(key); binning > 1)
      in.fail(fmt::format("{} is {:.6g}: the images are smaller than the calibration; give a calibration in their size",
                          key, binning));
  const double width = in.optional_number("roi.width"), height = in.optional_number("roi.height");
  const double x = in.optional_number("roi.x_offset"), y = in.optional_number("roi.y_offset");
  const bool is_whole = (width == 0 || width == camera.width) && (height == 0 || height == camera.height);
  if (!is_whole || x != 0 || y != 0)
    in.fail(
        fmt::format("roi is {:.6g} x {:.6g} pixels at {:.6g}, {:.6g}: the images are a part of the calibrated ones; "
                    "subtract the offset from cx and cy, and write the part's size as width and height",
                    width, height, x, y));
}

}  // namespace

Result<FileCameras> read_ros(Fields in) {
  Camera camera;
  in.pass_over({"camera_name", "camera_matrix.", "distortion_coefficients.", "rectification_matrix",
                "projection_matrix", "local_transform", "frame_id"});
  camera.width = in.size(in.spelling({"image_width", "width"}));
  camera.height = in.size(in.spelling({"image_height", "height"}));
  read_matrix(in, "camera_matrix.data", &camera);
  set_lens(in, "distortion_coefficients.data", &camera);
  return FileCameras{"ROS camera_info", {file_camera("", camera, in)}};
}

Result<FileCameras> read_ros_message(Fields in) {
  Camera camera;
  in.pass_over({"header", "r", "R", "p", "P"});
  camera.width = in.size("width");
  camera.height = in.size("height");
  read_matrix(in, in.spelling({"k", "K"}), &camera);
  set_lens(in, in.spelling({"d", "D"}), &camera);
  refuse_parts_of_the_image(in, camera);
  return FileCameras{"ROS camera_info", {file_camera("", camera, in)}};
}

}  // namespace rumi
