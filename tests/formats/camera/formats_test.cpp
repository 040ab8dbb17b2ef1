// SPDX-License-Identifier: BSD-3-Clause
// Tests files of other tools: they are told apart by their content, or refused with the tool's name.
#include <gmock/gmock.h>

#include "tests/formats/camera/foreign_camera.h"

namespace rumi {
namespace {

using ::testing::AllOf;
using testing::error_of;
using testing::expect_size_and_matrix;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::kOpenVslam;
using testing::parse;
using testing::with;

TEST(AdviceOnSize, TellsWhatTheSizesHaveInCommon) {
  Result<CameraFile> result = parse(kOpenVslam);
  EXPECT_THAT(advice_on_size(*result, 48, 64), HasSubstr("turned by 90 degrees"));
  EXPECT_THAT(advice_on_size(*result, 32, 24),
              AllOf(HasSubstr("made smaller"), HasSubstr("fx: 25"), HasSubstr("width: 32")));
  EXPECT_THAT(advice_on_size(*result, 128, 72), HasSubstr("another part of the sensor"));
}

TEST(CameraOfCamodocal, IsReadOrRefusedByItsModel) {
  const std::string pinhole =
      "%YAML:1.0\n---\nmodel_type: PINHOLE\ncamera_name: camera\nimage_width: 64\nimage_height: 48\n"
      "distortion_parameters:\n   k1: 0.1\n   k2: 0.2\n   p1: 0.3\n   p2: 0.4\n"
      "projection_parameters:\n   fx: 50\n   fy: 51\n   cx: 32\n   cy: 24\n";
  Result<CameraFile> result = parse(pinhole);
  ASSERT_EQ(result.error_text(), "");
  expect_size_and_matrix(result->camera);
  EXPECT_EQ(result->camera.p2, .4);
  result = parse(
      "model_type: KANNALA_BRANDT\nimage_width: 64\nimage_height: 48\nprojection_parameters:\n   k2: 0.1\n   k3: 0.2\n"
      "   k4: 0.3\n   k5: 0.4\n   mu: 50\n   mv: 51\n   u0: 32\n   v0: 24\n");
  ASSERT_EQ(result.error_text(), "");
  expect_size_and_matrix(result->camera);
  EXPECT_EQ(std::tie(result->camera.k1, result->camera.k4), std::make_tuple(.1, .4));
  EXPECT_THAT(error_of(with(pinhole, "PINHOLE", "MEI")), HasSubstr("model_type is 'MEI'"));
}

TEST(CamerasOfBasaltAndDepthAi, AreReadByTheirNames) {
  const Result<CameraFile> basalt = parse(
      "{\"value0\": {\"T_imu_cam\": [{\"px\": 0, \"qw\": 1}, {\"px\": 0.1, \"qw\": 1}], \"intrinsics\": "
      "[{\"camera_type\": \"kb4\", "
      "\"intrinsics\": {\"fx\": 50, \"fy\": 51, \"cx\": 32, \"cy\": 24, \"k1\": 0.1, \"k2\": 0.2, \"k3\": 0.3, \"k4\": "
      "0.4}}, "
      "{\"camera_type\": \"ds\", \"intrinsics\": {\"fx\": 50, \"fy\": 51, \"cx\": 32, \"cy\": 24, \"xi\": 0.1, "
      "\"alpha\": 0.2}}], "
      "\"resolution\": [[64, 48], [64, 48]], \"vignette\": []}}");
  ASSERT_EQ(basalt.error_text(), "");
  EXPECT_EQ(basalt->format, "Basalt");
  expect_size_and_matrix(basalt->camera);
  EXPECT_EQ(basalt->camera.k4, .4);
  EXPECT_THAT(basalt->others, IsEmpty());
  const std::string depthai =
      "{\"cameraData\": [[0, {\"cameraType\": 0, \"distortionCoeff\": [0.1, 0.2, 0.3, 0.4, 0.5, 0, 0, 0, 0, 0, 0, 0, "
      "0, 0], "
      "\"height\": 48, \"width\": 64, \"intrinsicMatrix\": [[50, 0, 32], [0, 51, 24], [0, 0, 1]], \"extrinsics\": "
      "{\"toCameraSocket\": "
      "1}}]]}";
  const Result<CameraFile> read = parse(depthai);
  ASSERT_EQ(read.error_text(), "");
  EXPECT_EQ(read->name, "CAM_A");
  expect_size_and_matrix(read->camera);
  EXPECT_THAT(error_of(with(depthai, "0.5, 0,", "0.5, 8.1,")), HasSubstr("(k4) is 8.1"));
}

TEST(FilesOfOthers, AreRefusedByTheirNames) {
  const std::pair<const char*, const char*> kStrangers[] = {
      {"P0: 7.2e+02 0 6.1e+02 0 0 7.1e+02 1.8e+02 0 0 0 1 0\nP1: 1 2 3\n", "fx: 720, fy: 710, cx: 610, cy: 180"},
      {"525.0 0 320\n0 525.0 240\n0 0 1\n", "numbers without names"},
      {"cam_model: Pinhole\ncam_fx: 414\n", "SVO"},
      {"cameras:\n  - {focal_length: [50, 51], image_dimension: [64, 48]}\n", "OKVIS"},
      {"%YAML:1.0\nimu: 1\ncam0_calib: \"cam0.yaml\"\n", "give the file that cam0_calib names"},
      {"# oST version 5.0 parameters\n[image]\nwidth\n640\n", "ost.yaml"},
      {"[LEFT_CAM_HD]\nfx=699\n", "ZED"},
      {"Camera-system parameters:\n\tcam0 (/a):\n\t projection: [1 2] +- [3 4]\n", "camchain"},
      {"Pinhole 50 51 32 24 0\n64 48\ncrop\n64 48\n", "DSO"},
      {"\xFF\xFE"
       "f",
       "UTF-16"},
      {"\x93NUMPY", "NumPy"},
      {"speed: 3\nname: robot\n", "speed, name"},
  };
  for (const auto& [text, name] : kStrangers)
    EXPECT_THAT(error_of(text), AllOf(HasSubstr("c.yaml: "), HasSubstr(name)));
}

// By anchors, a few bytes stand for a list of any length.
TEST(FilesOfOthers, CannotGrowInMemory) {
  std::string text = "a0: &a0 {x: 1, y: 2}\n";
  for (int i = 1; i < 9; ++i) {
    text += fmt::format("a{}: &a{} {{", i, i);
    for (int k = 0; k < 9; ++k) text += fmt::format("{}b{}: *a{}", k > 0 ? ", " : "", k, i - 1);
    text += "}\n";
  }
  EXPECT_THAT(error_of(text), HasSubstr("too many fields"));
}

}  // namespace
}  // namespace rumi
