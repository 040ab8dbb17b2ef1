// SPDX-License-Identifier: BSD-3-Clause
// A camera calibration in any format that rumi reads, as a file and as the text that comes with images. A good camera
// is used, written and read again; the file's other cameras are read by their names.
#include "bus/wire/calibration.h"
#include "bus/wire/working_image.h"
#include "formats/camera/camera_file.h"
#include "fuzz/good_messages.h"
#include "fuzz/scratch.h"

namespace rumi::fuzz {
namespace {

void use(const Result<CameraFile>& result) {
  if (!result) return;
  const Camera& camera = result->camera;
  if (!parse_camera(camera_to_yaml(camera), "again")) throw std::logic_error("a camera is not read back");
  camera.undistort({0, 0});
  camera.project({0.1, 0.2, 1});
  working_camera(camera, 640);
}

void run(View input) {
  use(parse_camera(to_text(input), "input"));
  const std::string file = scratch().write("camera", input);
  Result<CameraFile> result = read_camera_file(file);
  use(result);
  if (!result || result->others.empty()) return;
  for (const std::string name : {"cam1", "2", "Infrared 1"}) use(read_camera_file(file + ":" + name));
  const CameraFile::Other other = result->others.back();
  use(read_camera_file(file + ":" + other.lens));
  advice_on_size(*result, other.camera.width, other.camera.height);
  choose_size(other.camera.width, other.camera.height, &*result);
  use(result);
}

std::string matrix(const std::string& name, int rows, int columns, const std::string& data, bool is_opencv) {
  const std::string dt = is_opencv ? "  dt: d\n" : "";
  return name + (is_opencv ? ": !!opencv-matrix\n" : ":\n") + "  rows: " + std::to_string(rows) +
         "\n  cols: " + std::to_string(columns) + "\n" + dt + "  data: [" + data + "]\n";
}

std::vector<Bytes> seeds() {
  Camera fisheye = good_camera();
  fisheye.model = Camera::Model::kKannalaBrandt;
  fisheye.k4 = 0.001;
  const std::string size = "image_width: 64\nimage_height: 48\n", k = "50, 0, 32, 0, 51, 24, 0, 0, 1";
  const std::string d = "0.1, 0.2, 0.3, 0.4, 0";
  const std::string ros = size + matrix("camera_matrix", 3, 3, k, false) + "distortion_model: plumb_bob\n" +
                          matrix("distortion_coefficients", 1, 5, d, false);
  const std::string opencv = "%YAML:1.0\n---\n" + size + matrix("camera_matrix", 3, 3, k, true) +
                             matrix("distortion_coefficients", 1, 5, d, true) + "fisheye_model: 0\n";
  const std::string lens = "camera_model: pinhole\nintrinsics: [50, 51, 32, 24]\nresolution: [64, 48]\n";
  const std::string kalibr =
      "cam0: {camera_model: pinhole, intrinsics: [50, 51, 32, 24], distortion_model: equidistant, distortion_coeffs: "
      "[0.1, 0.2, 0.3, 0.4], resolution: [64, 48]}\n";
  const std::string euroc =
      lens + "rate_hz: 20\ndistortion_model: radial-tangential\ndistortion_coefficients: [0, 0, 0, 0]\n";
  std::string orb = "%YAML:1.0\nCamera.type: \"KannalaBrandt8\"\nCamera.width: 64\nCamera.height: 48\n";
  for (const char* line : {"fx: 50.0", "fy: 51.0", "cx: 32", "cy: 24", "k1: 0.1", "k2: 0.2", "k3: 0.3", "k4: 0.4"})
    orb += std::string("Camera1.") + line + "\n";
  const std::string stella =
      "Camera:\n  model: perspective\n  fx: 50\n  fy: 51\n  cx: 32\n  cy: 24\n  k1: 0.1\n  cols: 64\n  rows: 48\n";
  const std::string message =
      "height: 48\nwidth: 64\ndistortion_model: plumb_bob\nd: [0, 0, 0, 0, 0]\nk: [" + k + "]\nroi: {}\n---\n";
  const std::string vins = "model_type: PINHOLE\n" + size +
                           "projection_parameters: {fx: 50, fy: 51, cx: 32, cy: 24}\ndistortion_parameters: {k1: 0}\n";
  const std::string basalt =
      "{\"value0\": {\"intrinsics\": [{\"camera_type\": \"kb4\", \"intrinsics\": {\"fx\": 50, \"fy\": 51, \"cx\": 32, "
      "\"cy\": 24}}], \"resolution\": [[64, 48]]}}";
  const std::string depthai =
      "{\"cameraData\": [[0, {\"distortionCoeff\": [0, 0, 0, 0], \"height\": 48, \"width\": 64, \"intrinsicMatrix\": "
      "[[50, 0, "
      "32], [0, 51, 24], [0, 0, 1]]}]]}";
  const std::string block =
      "  Width: 64\n  Height: 48\n  PPX: 32\n  PPY: 24\n  Fx: 50\n  Fy: 51\n  Distortion: Brown Conrady\n"
      "  Coeffs: 0.1 0.2 0 0 0\n  FOV (deg): 65 x 50\n\n";
  const std::string realsense = "Device info:\n Name : RealSense\n Intrinsic of \"Color\" / 64x48 / {RGB8}\n" + block +
                                " Intrinsic of \"Infrared 1\" / 64x48 / {Y8}\n" + block;
  const std::string colmap =
      "# CAMERA_ID MODEL WIDTH HEIGHT PARAMS\n1 PINHOLE 64 48 50 51 32 24\n2 SIMPLE_RADIAL 64 48 50 32 24 0.1\n"
      "3 OPENCV_FISHEYE 64 48 50 51 32 24 0.1 0 0 0\n4 FULL_OPENCV 64 48 50 51 32 24 0.1 0 0 0 0 0 0 0\n";
  const auto xml_matrix = [](const std::string& name, const std::string& form, const std::string& data) {
    return "<" + name + " type_id=\"opencv-matrix\">" + form + "<dt>d</dt><data>" + data + "</data></" + name + ">\n";
  };
  const std::string xml =
      "<?xml version=\"1.0\"?>\n<opencv_storage>\n<image_Width>64</image_Width>\n" +
      xml_matrix("Camera_Matrix", "<rows>3</rows><cols>3</cols>", "50. 0. 32. 0. 51. 24. 0. 0. 1.") +
      xml_matrix("Distortion_Coefficients", "<rows>5</rows><cols>1</cols>", "0.1 0.2 0. 0. 0.") +
      "<image_Height>64</image_Height>\n</opencv_storage>\n";
  const std::string nerf =
      "{\"camera_model\": \"OPENCV\", \"frames\": [{\"file_path\": \"a.png\", \"fl_x\": 50, \"fl_y\": 51, \"cx\": 32, "
      "\"cy\": 24, \"w\": 64, \"h\": 48, \"k1\": 0.1, \"transform_matrix\": [[1, 0, 0, 0]]}]}";
  const std::string angle = "{\"camera_angle_x\": 1.2, \"w\": 64, \"h\": 48, \"frames\": []}";
  const std::string two =
      "cam0: &c {camera_model: pinhole, intrinsics: [50, 51, 32, 24], resolution: [64, 48]}\ncam1: *c\n";
  const std::string groups = "left:\n  image_width: 64\n  image_height: 48\n  camera_matrix: [" + k +
                             "]\n  dist_coeffs: [" + d + "]\nright: {camera_matrix: [1]}\n";
  return {to_bytes(realsense),
          to_bytes(colmap),
          to_bytes(nerf),
          to_bytes(angle),
          to_bytes(xml),
          to_bytes(two),
          to_bytes(groups),
          to_bytes(stella),
          to_bytes(message),
          to_bytes(vins),
          to_bytes(basalt),
          to_bytes(depthai),
          to_bytes(camera_to_yaml(good_camera())),
          to_bytes(camera_to_yaml(fisheye)),
          to_bytes(ros),
          to_bytes(opencv),
          to_bytes(kalibr),
          to_bytes(euroc),
          to_bytes(orb)};
}

const Registered registered({"calibration", run, seeds});

}  // namespace
}  // namespace rumi::fuzz
