// SPDX-License-Identifier: BSD-3-Clause
#include "formats/camera/camera_file.h"

#include <gmock/gmock.h>

#include "bus/wire/calibration.h"
#include "formats/camera/given_camera.h"
#include "tests/formats/recording.h"

namespace rumi {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

Camera parse(const std::string& text, const std::string& format) {
  const Result<CameraFile> result = parse_camera(text, "c.yaml");
  EXPECT_EQ(result.error_text(), "");
  EXPECT_EQ(result->format, format);
  return result->camera;
}

std::string error_of(const std::string& text) { return parse_camera(text, "c.yaml").error_text(); }

// Returns a flat calibration in which the line of `key` has another `value`, or is left out if that is "-".
std::string flat(const std::string& key, const std::string& value) {
  std::string out;
  for (const auto& [k, v] : std::vector<std::pair<std::string, std::string>>{
           {"fx", "50"}, {"fy", "51"}, {"cx", "32"}, {"cy", "24"}, {"k1", "0.1"}, {"width", "64"}, {"height", "48"}}) {
    const std::string& text = k == key ? value : v;
    if (text != "-") out += k + ": " + text + "\n";
  }
  return out;
}

TEST(CameraFile, OwnFormatComesBackExactly) {
  Camera c;
  c.width = 752, c.height = 480;
  c.fx = 458.654 / 3, c.fy = 457.296 / 7, c.cx = 367.215, c.cy = 248.375;
  c.k1 = -0.28340811 / 3, c.k2 = 1e-17, c.p1 = 0.00019359, c.p2 = 1.76187114e-05, c.k3 = 0.1 + 0.2, c.fps = 29.97;
  for (const Camera::Model model : {Camera::Model::kPinhole, Camera::Model::kKannalaBrandt}) {
    c.model = model;
    if (model == Camera::Model::kKannalaBrandt) c.p1 = c.p2 = 0, c.k4 = 1.0 / 3;
    const Camera back = parse(camera_to_yaml(c), "rumi");
    EXPECT_EQ(back.model, model);
    EXPECT_EQ(std::tie(back.width, back.height, back.fx, back.fy, back.cx, back.cy, back.fps),
              std::tie(c.width, c.height, c.fx, c.fy, c.cx, c.cy, c.fps));
    EXPECT_EQ(std::tie(back.k1, back.k2, back.p1, back.p2, back.k3, back.k4),
              std::tie(c.k1, c.k2, c.p1, c.p2, c.k3, c.k4));
  }
}

TEST(CameraFile, RosCameraInfo) {
  const std::string text =
      "image_width: 64\nimage_height: 48\ncamera_name: c\n"
      "camera_matrix:\n  rows: 3\n  cols: 3\n  data: [50., 0., 32., 0., 51., 24., 0., 0., 1.]\n"
      "distortion_model: {}\ndistortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [{}]\n";
  Camera c = parse(fmt::format(fmt::runtime(text), "plumb_bob", "0.1, 0.2, 0.3, 0.4, 0.5"), "ROS camera_info");
  EXPECT_EQ(std::tie(c.fx, c.fy, c.cx, c.cy), std::make_tuple(50., 51., 32., 24.));
  EXPECT_EQ(std::tie(c.k1, c.k2, c.p1, c.p2, c.k3), std::make_tuple(.1, .2, .3, .4, .5));
  c = parse(fmt::format(fmt::runtime(text), "equidistant", "0.1, 0.2, 0.3, 0.4"), "ROS camera_info");
  EXPECT_EQ(c.model, Camera::Model::kKannalaBrandt);
  EXPECT_EQ(std::tie(c.k1, c.k2, c.k3, c.k4), std::make_tuple(.1, .2, .3, .4));
  c = parse(fmt::format(fmt::runtime(text), "rational_polynomial", "0.1, 0.2, 0.3, 0.4, 0.5, 0, 0, 0"),
            "ROS camera_info");
  EXPECT_EQ(c.k3, 0.5);
  EXPECT_THAT(error_of(fmt::format(fmt::runtime(text), "rational_polynomial", "0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0, 0")),
              AllOf(HasSubstr("c.yaml"), HasSubstr("k4"), HasSubstr("0.6"), HasSubstr("calibrate again")));
}

TEST(CameraFile, OpenCvKalibrEurocOrbSlam) {
  Camera c = parse(
      "%YAML:1.0\n---\nimage_width: 64\nimage_height: 48\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   "
      "dt: d\n"
      "   data: [ 50., 0., 32., 0., 51., 24., 0., 0., 1. ]\ndistortion_coefficients: !!opencv-matrix\n   rows: 5\n"
      "   cols: 1\n   dt: d\n   data: [ 1.0e-01, 0.2, 0.3, 0.4, 0.5 ]\n",
      "OpenCV");
  EXPECT_EQ(std::tie(c.width, c.height, c.fx, c.k1, c.k3), std::make_tuple(64, 48, 50., .1, .5));
  c = parse(
      "cam0:\n  camera_model: pinhole\n  intrinsics: [50, 51, 32, 24]\n  distortion_model: equidistant\n"
      "  distortion_coeffs: [0.1, 0.2, 0.3, 0.4]\n  resolution: [64, 48]\n",
      "Kalibr");
  EXPECT_EQ(c.model, Camera::Model::kKannalaBrandt);
  EXPECT_EQ(std::tie(c.width, c.height, c.fy, c.k4), std::make_tuple(64, 48, 51., .4));
  c = parse(
      "sensor_type: camera\nrate_hz: 20\nresolution: [64, 48]\ncamera_model: pinhole\nintrinsics: [50, 51, 32, 24]\n"
      "distortion_model: radial-tangential\ndistortion_coefficients: [0.1, 0.2, 0.3, 0.4]\n",
      "EuRoC");
  EXPECT_EQ(std::tie(c.p2, c.fps), std::make_tuple(.4, 20.));
  for (const std::string prefix : {"Camera.", "Camera1."}) {
    std::string text = "%YAML:1.0\nCamera.width: 64\nCamera.height: 48\nCamera.fps: 30\n";
    for (const char* line : {"fx: 50.0", "fy: 51.0", "cx: 32", "cy: 24", "k1: 0.1", "k2: 0.2", "k3: 0.3", "k4: 0.4"})
      text += prefix + line + "\n";
    c = parse(text + "Camera.type: \"KannalaBrandt8\"\n", "ORB-SLAM3");
    EXPECT_EQ(c.k4, 0.4);
    EXPECT_THAT(error_of(text + "Camera.type: \"PinHole\"\n"), HasSubstr(prefix + "k4 is 0.4"));
    text.resize(text.find(prefix + "k4"));
    c = parse(text + "Camera.type: \"PinHole\"\n", "ORB-SLAM3");
    EXPECT_EQ(std::tie(c.k3, c.k4, c.fps), std::make_tuple(.3, 0., 30.));
  }
}

TEST(CameraFile, BadFieldsAreNamed) {
  for (const char* bad : {"nan", ".nan", "inf", "abc", "", "[1]", "50,5", "1e999", "0", "-50", "5e9"})
    EXPECT_THAT(error_of(flat("fx", bad)), AllOf(HasSubstr("c.yaml"), HasSubstr("fx"))) << bad;
  EXPECT_THAT(error_of(flat("cy", "-")), AllOf(HasSubstr("cy is missing"), HasSubstr("add 'cy:")));
  EXPECT_THAT(error_of(flat("width", "64.5")), HasSubstr("width is '64.5'"));
  EXPECT_THAT(error_of(flat("width", "0")), HasSubstr("width"));
  EXPECT_THAT(error_of(flat("k1", "nan")), HasSubstr("k1 is 'nan'"));
  EXPECT_THAT(error_of(flat("cx", "640")), HasSubstr("cx is 640"));
  EXPECT_THAT(error_of(flat("", "") + "K1: 0.3\n"), HasSubstr("'K1' is not known"));
  EXPECT_THAT(error_of(flat("", "") + "fx: 60\n"), HasSubstr("fx is given twice"));
  EXPECT_THAT(error_of(flat("", "") + "model: omni\n"), HasSubstr("'omni'"));
}

TEST(CameraFile, BadTextIsRefused) {
  EXPECT_THAT(error_of(""), HasSubstr("is empty"));
  EXPECT_THAT(error_of(" \n\n"), HasSubstr("is empty"));
  EXPECT_THAT(error_of(std::string("\x00\x01\x02\xff\xd8", 5)), HasSubstr("not a text file"));
  EXPECT_THAT(error_of("fx: [1, 2"), HasSubstr("not correct YAML"));
  EXPECT_THAT(error_of(std::string(60000, '[')), HasSubstr("c.yaml"));
  EXPECT_THAT(error_of(std::string(100000, 'x')), HasSubstr("longer than 65536 bytes"));
  EXPECT_THAT(error_of("just words"), HasSubstr("key: value"));
  EXPECT_THAT(read_camera_file("/nowhere/c.yaml").error_text(),
              AllOf(HasSubstr("/nowhere/c.yaml"), HasSubstr("no such file")));
  EXPECT_THAT(read_camera_file("/tmp").error_text(), HasSubstr("is a folder"));
}

TEST(CameraFile, OneThatAUserNamedStopsAProcessAtItsStart) {
  EXPECT_EQ(read_given_camera(""), std::nullopt);
  EXPECT_THROW(read_given_camera("/nowhere/camera.yaml"), std::runtime_error);
}

// Each prefix of a file, as a full disk leaves it, is read or refused without an exception.
TEST(CameraFile, TruncatedFilesNeverThrow) {
  const std::string text = "%YAML:1.0\n---\n" + flat("", "") + "camera_matrix: !!opencv-matrix\n  data: [1, 2]\n";
  for (size_t n = 0; n < text.size(); ++n) EXPECT_NO_THROW(parse_camera(text.substr(0, n), "c.yaml")) << n;
}

TEST(CameraFile, ShippedCalibrationsAreRight) {
  int count = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(RUMI_SOURCE_DIR) / "config/cameras")) {
    EXPECT_EQ(read_camera_file(entry.path().string()).error_text(), "");
    ++count;
  }
  EXPECT_GE(count, 6);
}

}  // namespace
}  // namespace rumi
