// SPDX-License-Identifier: BSD-3-Clause
// Tests the reading of camera files of OpenCV, and of programs that write as it does.
#include <gmock/gmock.h>

#include "tests/formats/camera/foreign_camera.h"

namespace rumi {
namespace {

using ::testing::AllOf;
using testing::CameraFiles;
using ::testing::ElementsAre;
using testing::error_of;
using testing::expect_size_and_matrix;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::parse;
using testing::with;

constexpr const char* kOpenCv =
    "%YAML:1.0\n---\ncalibration_time: \"now\"\nimage_width: 64\nimage_height: 48\ncamera_matrix: !!opencv-matrix\n"
    "   rows: 3\n   cols: 3\n   dt: d\n   data: [ 50., 0., 32., 0., 51., 24., 0., 0., 1. ]\n"
    "distortion_coefficients: !!opencv-matrix\n   rows: 5\n   cols: 1\n   dt: d\n   data: [ 0.1, 0.2, 0.3, 0.4, 0.5 ]\n"
    "avg_reprojection_error: 0.21\n";

TEST(CameraOfOpenCv, ASmallSkewIsLeftOutAndTold) {
  const Result<CameraFile> result = parse(with(kOpenCv, "50., 0.,", "50., 0.083,"));
  ASSERT_EQ(result.error_text(), "");
  expect_size_and_matrix(result->camera);
  EXPECT_THAT(result->notes, ElementsAre(HasSubstr("0.083")));
  EXPECT_THAT(error_of(with(kOpenCv, "50., 0.,", "50., 2.5,")),
              AllOf(HasSubstr("skew of 2.5 px"), HasSubstr("undistort")));
  EXPECT_THAT(parse(kOpenCv).value().notes, IsEmpty());
}

TEST(CameraOfOpenCv, MayHaveListsOfRows) {
  const Result<CameraFile> result = parse(
      "image_size: [64, 48]\ncamera_matrix: [[50, 0, 32], [0, 51, 24], [0, 0, 1]]\ndist_coeff: [[0.1, 0.2, 0.3, 0.4, "
      "0.5]]\n");
  ASSERT_EQ(result.error_text(), "");
  expect_size_and_matrix(result->camera);
  EXPECT_EQ(result->camera.k3, .5);
}

TEST(CameraOfOpenCv, AMatrixOfMatlabIsRefused) {
  EXPECT_THAT(
      error_of(with(kOpenCv, "50., 0., 32., 0., 51., 24., 0., 0., 1.", "50., 0., 0., 0., 51., 0., 32., 24., 1.")),
      HasSubstr("column by column"));
}

TEST_F(CameraFiles, OfOpenCvMayBeXmlOrJson) {
  const std::string xml = write(
      "c.xml",
      "<?xml version=\"1.0\"?>\n<opencv_storage>\n<image_width>64</image_width>\n<image_height>48</image_height>\n"
      "<camera_matrix type_id=\"opencv-matrix\">\n<rows>3</rows>\n<cols>3</cols>\n<dt>d</dt>\n<data>50. 0. 32. 0. 51. "
      "24. "
      "0. 0. 1.</data></camera_matrix>\n<distortion_coefficients "
      "type_id=\"opencv-matrix\">\n<rows>5</rows>\n<cols>1</cols>\n"
      "<dt>d</dt>\n<data>0.1 0.2 0.3 0.4 0.5</data></distortion_coefficients>\n</opencv_storage>\n");
  const std::string json = write("c.json",
                                 "{\n\t\"image_width\": 64,\n\t\"image_height\": 48,\n\t\"camera_matrix\": "
                                 "{\n\t\t\"type_id\": \"opencv-matrix\",\n"
                                 "\t\t\"rows\": 3, \"cols\": 3, \"dt\": \"d\",\n\t\t\"data\": [ 50.0, 0.0, 32.0, 0.0, "
                                 "51.0, 24.0, 0.0, 0.0, 1.0 ]\n\t},\n"
                                 "\t\"distortion_coefficients\": {\"type_id\": \"opencv-matrix\", \"rows\": 5, "
                                 "\"cols\": 1, \"dt\": \"d\", \"data\": [0.1, "
                                 "0.2, 0.3, 0.4, 0.5]}\n}\n");
  for (const std::string& file : {xml, json}) {
    const Result<CameraFile> result = read_camera_file(file);
    ASSERT_EQ(result.error_text(), "");
    EXPECT_EQ(result->format, "OpenCV");
    expect_size_and_matrix(result->camera);
    EXPECT_EQ(result->camera.k3, .5);
  }
  EXPECT_THAT(read_camera_file(write("d.xml", "<?xml version=\"1.0\"?><opencv_storage><image_width>64</")).error_text(),
              HasSubstr("d.xml"));
  EXPECT_THAT(
      read_camera_file(write("m.xml", "<?xml version=\"1.0\"?><calibration><f>1</f></calibration>")).error_text(),
      HasSubstr("XML"));
}

TEST(CameraOfOpenCv, NeedsNoSpaceBehindAColon) {
  const std::string text = with(with(kOpenCv, "data: [ 50.", "data:[ 50."), "image_width: 64", "image_width:64");
  EXPECT_EQ(error_of(text), "");
  expect_size_and_matrix(parse(text).value().camera);
}

TEST(CameraOfOpenCv, MayBeAGroup) {
  const std::string camera =
      "image_width: 64, image_height: 48, camera_matrix: [50, 0, 32, 0, 51, 24, 0, 0, 1], distortion_coefficients: [0, "
      "0, 0, 0]";
  const Result<CameraFile> result = parse(fmt::format("camera0: {{{0}}}\ncamera1: {{{0}}}\n", camera));
  ASSERT_EQ(result.error_text(), "");
  EXPECT_EQ(result->name, "camera0");
  expect_size_and_matrix(result->camera);
  EXPECT_EQ(result->others.size(), 1u);
}

TEST(CameraOfAFisheye, IsNeverTakenForAPinhole) {
  const std::string text =
      "camera_matrix: [50, 0, 32, 0, 51, 24, 0, 0, 1]\ndist_coeffs: [0.1, 0.2, 0.01, 0.02]\nimage_width: 64\n"
      "image_height: 48\n";
  EXPECT_EQ(error_of(text), "");
  EXPECT_EQ(error_of(text + "is_fisheye: false\n"), "");
  EXPECT_EQ(parse(text + "fisheye_model: 1\n").value().camera.model, Camera::Model::kKannalaBrandt);
  for (const char* sign : {"is_fisheye: true\n", "camera_model: fisheye\n", "model: Equidistant\n"})
    EXPECT_THAT(error_of(text + sign), HasSubstr("fisheye_model: 1")) << sign;
  EXPECT_THAT(
      error_of("fisheye_left:\n  camera_matrix: [50, 0, 32, 0, 51, 24, 0, 0, 1]\n  dist_coeffs: [0.1, 0.2, 0.01, "
               "0.02]\n  image_width: 64\n  image_height: 48\n"),
      HasSubstr("fisheye"));
}

}  // namespace
}  // namespace rumi
