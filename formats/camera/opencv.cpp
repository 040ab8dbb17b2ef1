// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <opencv2/core/persistence.hpp>

#include "formats/camera/formats.h"
#include "formats/camera/lens.h"

namespace rumi {
namespace {

// Returns the key under which the file has the values of a matrix. FileStorage has a group that holds them; files
// written by hand or in Python have a list, or a list of rows.
std::string matrix_key(const Fields& in, std::initializer_list<const char*> spellings) {
  for (const std::string key : spellings) {
    if (in.has(key)) return key;
    if (in.has(key + ".data")) return key + ".data";
  }
  return std::string(*spellings.begin()) + ".data";
}

void read_image_size(Fields& in, Camera* camera) {
  const std::string both = in.spelling({"image_size", "imageSize", "img_size", "size", "resolution"});
  if (in.has(both)) {
    const std::vector<double> size = in.list(both, "width, height", 2);
    for (const double side : size)
      if (!is_side(side)) return in.fail(both + ": must be whole numbers of pixels");
    camera->width = static_cast<int>(size[0]), camera->height = static_cast<int>(size[1]);
    return;
  }
  camera->width = in.size(in.spelling({"image_width", "image_Width", "imageWidth", "width", "ImageWidth"}));
  camera->height = in.size(in.spelling({"image_height", "image_Height", "imageHeight", "height", "ImageHeight"}));
}

void emit(const cv::FileNode& node, int depth, YAML::Emitter* out) {
  if (node.isInt()) {
    *out << static_cast<int>(node);
  } else if (node.isReal()) {
    *out << YAML::DoublePrecision(17) << static_cast<double>(node);
  } else if (node.isSeq() && depth < 8) {
    *out << YAML::BeginSeq;
    for (const cv::FileNode& item : node) emit(item, depth + 1, out);
    *out << YAML::EndSeq;
  } else if (node.isMap() && depth < 8) {
    *out << YAML::BeginMap;
    for (const cv::FileNode& item : node) {
      *out << YAML::Key << item.name() << YAML::Value;
      emit(item, depth + 1, out);
    }
    *out << YAML::EndMap;
  } else {
    *out << (node.isString() ? static_cast<std::string>(node) : std::string());
  }
}

// Fails if keys or values, as some programs write them, say that the lens is a fisheye: four numbers may be k1 k2 p1
// p2, or a fisheye's k1 k2 k3 k4.
void refuse_other_fisheyes(Fields& in) {
  for (const std::string& name : in.names()) {
    const std::string key = name.substr(in.full("").size()), value = lower_case(in.text(key, ""));
    const bool says_no = value == "0" || value == "false" || value == "no";
    const bool is_meant = lower_case(key).find("fisheye") != std::string::npos ||
                          value.find("fisheye") != std::string::npos || value.find("equidistant") != std::string::npos;
    if (is_meant && !says_no)
      return in.fail(
          fmt::format("{} is {}: for a fisheye add 'fisheye_model: 1', for another lens 'fisheye_model: 0' "
                      "and remove it",
                      name, in.quoted(key)));
  }
}

}  // namespace

Result<FileCameras> read_opencv(Fields in) {
  Camera camera;
  const std::string matrix =
      matrix_key(in, {"camera_matrix", "Camera_Matrix", "cameraMatrix", "CameraMatrix", "intrinsic_matrix", "mtx"});
  const std::string lens =
      matrix_key(in, {"distortion_coefficients", "Distortion_Coefficients", "dist_coeffs", "dist_coeff", "distCoeffs",
                      "DistCoeffs", "distortionCoefficients", "distortion_coeffs", "distortion", "dist"});
  read_image_size(in, &camera);
  read_matrix(in, matrix, &camera);
  const std::vector<double> d = in.list(lens, "k1, k2, p1, p2, k3");
  // Only the key that OpenCV's calibration sample writes tells fisheye from pinhole.
  const bool fisheye = in.optional_number("fisheye_model") != 0;
  if (!fisheye && d.size() == 4) refuse_other_fisheyes(in);
  fisheye ? set_fisheye(in, d, lens, &camera) : set_radial_tangential(in, d, lens, &camera);
  in.pass_over({"calibration_time",
                "calibration_date",
                "nframes",
                "nr_of_frames",
                "nrOfFrames",
                "board_",
                "square_",
                "aspectRatio",
                "fix_aspect_ratio",
                "flags",
                "avg_reprojection_error",
                "Avg_Reprojection_Error",
                "per_view_",
                "Per_View_",
                "per_frame_",
                "extrinsic_parameters",
                "Extrinsic_Parameters",
                "image_points",
                "Image_points",
                "grid_points",
                "rms",
                "reprojection_error",
                "marker_",
                "dictionary",
                "camera_name"});
  in.pass_over({"camera_matrix.", "Camera_Matrix.", "cameraMatrix.", "CameraMatrix.", "distortion_coefficients.",
                "Distortion_Coefficients.", "dist_coeffs.", "distCoeffs.", "distortionCoefficients.", "DistCoeffs."});
  return FileCameras{"OpenCV", {file_camera("", camera, in)}};
}

std::string yaml_of_opencv_xml(const std::string& xml) {
  if (xml.find("<opencv_storage") == std::string::npos) return "";
  try {
    const cv::FileStorage storage(xml, cv::FileStorage::READ | cv::FileStorage::MEMORY | cv::FileStorage::FORMAT_XML);
    YAML::Emitter out;
    emit(storage.root(), 0, &out);
    return out.good() ? out.c_str() : "";
  } catch (const std::exception&) {
    return "";
  }
}

}  // namespace rumi
