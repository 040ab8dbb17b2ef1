// SPDX-License-Identifier: BSD-3-Clause
// Reads lens profiles of Gyroflow (GoPro and others): OpenCV's fisheye, calibrated in the size calib_dimension.
#include <fmt/format.h>

#include "formats/camera/formats.h"
#include "formats/camera/lens.h"

namespace rumi {

Result<FileCameras> read_gyroflow(Fields in) {
  Camera camera;
  camera.width = in.size("calib_dimension.w"), camera.height = in.size("calib_dimension.h");
  const std::pair<const char*, int> others[] = {{"fisheye_params.image_width", camera.width},
                                                {"fisheye_params.image_height", camera.height}};
  for (const auto& [key, side] : others)
    if (in.has(key) && in.size(key) != side)
      in.fail(fmt::format("{} is {}, and calib_dimension is {} x {}: remove the one that is wrong", key, in.quoted(key),
                          camera.width, camera.height));
  read_matrix(in, "fisheye_params.camera_matrix", &camera);
  const std::string model = in.text("distortion_model", "opencv_fisheye");
  if (model == "opencv_fisheye")
    set_fisheye(in, in.list("fisheye_params.distortion_coeffs", "k1, k2, k3, k4"), "fisheye_params.distortion_coeffs",
                &camera);
  else
    refuse_model(in, "distortion_model", model, "opencv_fisheye");
  camera.fps = in.optional_number("fps");
  in.pass_over({"orig_dimension", "output_dimension"});  // sizes of the video before and after
  FileCamera read = file_camera("", camera, in);
  read.notes.clear();  // they only name fields that do not matter here
  return FileCameras{"Gyroflow", {read}};
}

}  // namespace rumi
