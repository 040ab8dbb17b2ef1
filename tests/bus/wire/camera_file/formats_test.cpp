// SPDX-License-Identifier: BSD-3-Clause
// The files of other tools, as they are: read in full, or refused by the name of what is not read.
#include "bus/wire/camera_file/formats.h"

#include <gmock/gmock.h>

#include "bus/wire/camera_file.h"
#include "tests/camera_driver/recording.h"

namespace rumi {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

CameraFileResult parse(const std::string& text) { return parse_camera(text, "c.yaml"); }
std::string error_of(const std::string& text) { return parse(text).error; }

void expect_size_and_matrix(const Camera& c) {
  EXPECT_EQ(std::tie(c.width, c.height, c.fx, c.fy, c.cx, c.cy), std::make_tuple(64, 48, 50., 51., 32., 24.));
}

// `text` with one piece of it replaced.
std::string with(std::string text, const std::string& piece, const std::string& other) {
  const size_t at = text.find(piece);
  EXPECT_NE(at, std::string::npos) << piece;
  return text.replace(at, piece.size(), other);
}

class CameraFiles : public ::testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& text) {
    testing::write(folder_.path() / name, text);
    return (folder_.path() / name).string();
  }
  testing::TemporaryFolder folder_;
};

constexpr const char* kOpenVslam =
    "Camera.name: \"a camera\"\nCamera.setup: \"monocular\"\nCamera.model: \"perspective\"\nCamera.fx: 50.0\n"
    "Camera.fy: 51.0\nCamera.cx: 32.0\nCamera.cy: 24.0\nCamera.k1: 0.1\nCamera.k2: 0.2\nCamera.p1: 0.3\n"
    "Camera.p2: 0.4\nCamera.k3: 0.5\nCamera.fps: 30.0\nCamera.cols: 64\nCamera.rows: 48\nCamera.color_order: \"RGB\"\n"
    "Feature.max_num_keypoints: 1000\n";

TEST(CameraOfOpenVslam, IsReadWithItsColumnsAndRows) {
  const CameraFileResult result = parse(kOpenVslam);
  ASSERT_EQ(result.error, "");
  EXPECT_EQ(result.format, "OpenVSLAM");
  expect_size_and_matrix(result.camera);
  EXPECT_EQ(std::tie(result.camera.k3, result.camera.p2, result.camera.fps), std::make_tuple(.5, .4, 30.));
  EXPECT_THAT(result.notes, IsEmpty());
}

TEST(CameraOfOpenVslam, IsReadAsAGroup) {
  const CameraFileResult result = parse(
      "Camera:\n  name: a\n  setup: monocular\n  model: perspective\n  fx: 50\n  fy: 51\n  cx: 32\n  cy: 24\n  k1: "
      "0.1\n"
      "  k2: 0\n  p1: 0\n  p2: 0\n  k3: 0\n  fps: 30.0\n  cols: 64\n  rows: 48\n  color_order: RGB\n"
      "Preprocessing:\n  min_size: 800\nFeature:\n  name: default\n");
  ASSERT_EQ(result.error, "");
  expect_size_and_matrix(result.camera);
  EXPECT_THAT(result.notes, IsEmpty());
}

TEST(CameraOfOpenVslam, MayBeAFisheye) {
  const std::string fisheye =
      with(with(kOpenVslam, "perspective", "fisheye"), "Camera.p1: 0.3\nCamera.p2: 0.4\n", "Camera.k4: 0.6\n");
  const CameraFileResult result = parse(fisheye);
  ASSERT_EQ(result.error, "");
  EXPECT_EQ(result.camera.model, Camera::Model::kKannalaBrandt);
  const Camera& c = result.camera;
  EXPECT_EQ(std::tie(c.k1, c.k2, c.k3, c.k4), std::make_tuple(.1, .2, .5, .6));
  EXPECT_THAT(error_of(with(kOpenVslam, "perspective", "fisheye")), HasSubstr("Camera.p1 is '0.3'"));
}

TEST(CameraOfOpenVslam, OfAnotherModelIsRefusedByItsName) {
  for (const char* model : {"equirectangular", "radial_division", "cubemap"})
    EXPECT_THAT(error_of(with(kOpenVslam, "perspective", model)),
                HasSubstr(fmt::format("Camera.model is '{}'", model)));
  EXPECT_THAT(error_of("Camera.model: equirectangular\nCamera.cols: 64\nCamera.rows: 48\n"),
              HasSubstr("Camera.model is 'equirectangular'"));
}

TEST(CameraOfOpenVslam, DoesNotLoseACoefficient) {
  EXPECT_THAT(error_of(std::string(kOpenVslam) + "Camera.k4: 0.002\n"),
              AllOf(HasSubstr("Camera.k4 is 0.002"), HasSubstr("fisheye")));
  EXPECT_THAT(error_of(std::string(kOpenVslam) + "Camera.xi: 0.9\n"), HasSubstr("Camera.xi is '0.9'"));
  EXPECT_EQ(error_of(std::string(kOpenVslam) + "Camera.k4: 0\n"), "");
  EXPECT_THAT(error_of(std::string(kOpenVslam) + "Camera.width: 640\n"), HasSubstr("Camera.width is '640'"));
  EXPECT_THAT(error_of(std::string(kOpenVslam) + "Camera.fx: 60\n"), HasSubstr("Camera.fx is given twice"));
}

constexpr const char* kOrbSlam =
    "%YAML:1.0\nFile.version: \"1.0\"\nCamera.type: \"PinHole\"\nCamera1.fx: 50.0\nCamera1.fy: 51.0\nCamera1.cx: 32.0\n"
    "Camera1.cy: 24.0\nCamera1.k1: 0.1\nCamera1.k2: 0.2\nCamera1.p1: 0.3\nCamera1.p2: 0.4\nCamera.width: 64\n"
    "Camera.height: 48\nCamera.fps: 30\nCamera.RGB: 1\nORBextractor.nFeatures: 1200\n";

TEST(CameraOfOrbSlam, IsReadWithoutAWordOnTheRest) {
  const CameraFileResult result = parse(kOrbSlam);
  ASSERT_EQ(result.error, "");
  expect_size_and_matrix(result.camera);
  EXPECT_THAT(result.notes, IsEmpty());
}

TEST(CameraOfOrbSlam, RectifiedTellsWhatItLeavesOut) {
  const CameraFileResult result = parse(with(kOrbSlam, "PinHole", "Rectified"));
  ASSERT_EQ(result.error, "");
  EXPECT_FALSE(result.camera.has_distortion());
  EXPECT_THAT(result.notes, ElementsAre(AllOf(HasSubstr("c.yaml"), HasSubstr("Camera1.k1 (0.1)"),
                                              HasSubstr("Camera1.p2 (0.4)"), HasSubstr("must be rectified"))));
}

TEST(CameraOfOrbSlam, TellsOfSizesThatItDoesNotUse) {
  EXPECT_THAT(parse(std::string(kOrbSlam) + "Camera.newWidth: 32\nCamera.newHeight: 48\n").notes,
              ElementsAre(HasSubstr("Camera.newWidth is '32'")));
  EXPECT_THAT(parse(std::string(kOrbSlam) + "Camera.imageScale: 0.5\n").notes, ElementsAre(HasSubstr("imageScale")));
  EXPECT_THAT(parse(std::string(kOrbSlam) + "Lens.maker: nobody\n").notes, ElementsAre(HasSubstr("Lens.maker")));
}

TEST(CameraOfOrbSlam, MayHaveASecondOne) {
  const std::string second = "Camera2.fx: 40\nCamera2.fy: 41\nCamera2.cx: 32\nCamera2.cy: 24\nCamera2.k1: 0.7\n";
  const CameraFileResult result = parse(kOrbSlam + second);
  ASSERT_EQ(result.error, "");
  EXPECT_EQ(result.camera.fx, 50);
  ASSERT_EQ(result.others.size(), 1u);
  EXPECT_EQ(result.others[0].name, "Camera2");
  EXPECT_EQ(std::tie(result.others[0].camera.fx, result.others[0].camera.k1), std::make_tuple(40., .7));
}

TEST(CameraOfOrbSlam, MayHaveItsCoefficientsAsAList) {
  const std::string list =
      "%YAML:1.0\nCamera.fx: 50\nCamera.fy: 51\nCamera.cx: 32\nCamera.cy: 24\nCamera.width: 64\n"
      "Camera.height: 48\nDistCoef: !!opencv-matrix\n  rows: 4\n  cols: 1\n  dt: f\n"
      "  data: [0.1, 0.2, 0.3, 0.4]\n";
  const CameraFileResult result = parse(list);
  ASSERT_EQ(result.error, "");
  EXPECT_EQ(std::tie(result.camera.k1, result.camera.p2), std::make_tuple(.1, .4));
}

constexpr const char* kCamchain =
    "cam0:\n  cam_overlaps: [1]\n  camera_model: pinhole\n  distortion_coeffs: [0.1, 0.2, 0.3, 0.4]\n"
    "  distortion_model: radtan\n  intrinsics: [70, 71, 40, 30]\n  resolution: [80, 60]\n  rostopic: /left\n"
    "cam1:\n  T_cn_cnm1:\n  - [1.0, 0.0, 0.0, -0.11]\n  - [0.0, 1.0, 0.0, 0.0]\n  - [0.0, 0.0, 1.0, 0.0]\n"
    "  - [0.0, 0.0, 0.0, 1.0]\n  camera_model: pinhole\n  distortion_coeffs: [0, 0, 0, 0]\n  distortion_model: radtan\n"
    "  intrinsics: [50, 51, 32, 24]\n  resolution: [64, 48]\n  rostopic: /right\n";

TEST_F(CameraFiles, OfKalibrNameTheirCameras) {
  const std::string file = write("camchain.yaml", kCamchain);
  const CameraFileResult first = read_camera_file(file);
  ASSERT_EQ(first.error, "");
  EXPECT_EQ(first.camera.width, 80);
  EXPECT_THAT(first.notes, ElementsAre(AllOf(HasSubstr("cam0, cam1"), HasSubstr("cam0 is taken"))));
  EXPECT_THAT(advice_on_size(first, 64, 48), HasSubstr("give --camera " + file + ":cam1"));
  const CameraFileResult second = read_camera_file(file + ":cam1");
  ASSERT_EQ(second.error, "");
  expect_size_and_matrix(second.camera);
  EXPECT_THAT(second.notes, IsEmpty());
  EXPECT_THAT(read_camera_file(file + ":cam7").error, AllOf(HasSubstr("no camera 'cam7'"), HasSubstr("cam0, cam1")));
  EXPECT_THAT(read_camera_file(write("one.yaml", kOrbSlam) + ":cam1").error, HasSubstr("has one camera only"));
  EXPECT_THAT(read_camera_file((folder_.path() / "no.yaml:cam1").string()).error,
              HasSubstr("no.yaml:cam1: no such file"));
}

TEST_F(CameraFiles, MayHaveAColonInTheirName) {
  write("rig.yaml", kCamchain);
  const CameraFileResult result = read_camera_file(write("rig.yaml:cam1", with(kCamchain, "[80, 60]", "[100, 60]")));
  ASSERT_EQ(result.error, "");
  EXPECT_EQ(result.camera.width, 100);
}

TEST_F(CameraFiles, OfKalibrAreRefusedByTheCameraThatIsAskedFor) {
  const std::string file = write("c.yaml", with(kCamchain, "camera_model: pinhole", "camera_model: omni"));
  EXPECT_THAT(read_camera_file(file).error, AllOf(HasSubstr("cam0.camera_model is 'omni'"), HasSubstr(file + ":cam1")));
  EXPECT_EQ(read_camera_file(file + ":cam1").error, "");
  EXPECT_THAT(error_of(with(kCamchain, "  distortion_model: radtan\n", "")),
              HasSubstr("cam0.distortion_model is none or missing"));
}

TEST(AdviceOnSize, TellsWhatTheSizesHaveInCommon) {
  CameraFileResult result = parse(kOpenVslam);
  EXPECT_THAT(advice_on_size(result, 48, 64), HasSubstr("turned by 90 degrees"));
  EXPECT_THAT(advice_on_size(result, 32, 24),
              AllOf(HasSubstr("made smaller"), HasSubstr("fx: 25"), HasSubstr("width: 32")));
  EXPECT_THAT(advice_on_size(result, 128, 72), HasSubstr("another part of the sensor"));
}

constexpr const char* kRos2Echo =
    "header:\n  stamp:\n    sec: 1\n    nanosec: 2\n  frame_id: f\nheight: 48\nwidth: 64\ndistortion_model: plumb_bob\n"
    "d:\n- 0.1\n- 0.2\n- 0.3\n- 0.4\n- 0.5\nk:\n- 50.0\n- 0.0\n- 32.0\n- 0.0\n- 51.0\n- 24.0\n- 0.0\n- 0.0\n- 1.0\n"
    "r:\n- 1.0\np:\n- 50.0\nbinning_x: 0\nbinning_y: 0\nroi:\n  x_offset: 0\n  y_offset: 0\n  height: 0\n  width: 0\n"
    "  do_rectify: false\n---\n";

TEST(CameraInfoAsPrinted, IsRead) {
  for (const std::string& text :
       {std::string(kRos2Echo), kRos2Echo + with(kRos2Echo, "50.0", "60.0"),
        std::string("header:\n  seq: 1\n  stamp:\n    secs: 1\n    nsecs: 2\n  frame_id: \"f\"\nheight: 48\n"
                    "width: 64\ndistortion_model: \"plumb_bob\"\nD: [0.1, 0.2, 0.3, 0.4, 0.5]\nK: [50.0, 0.0, "
                    "32.0, 0.0, 51.0, 24.0, 0.0, 0.0, 1.0]\nR: [1.0]\nP: [50.0]\nbinning_x: 0\nbinning_y: 0\n---\n")}) {
    const CameraFileResult result = parse(text);
    ASSERT_EQ(result.error, "");
    EXPECT_EQ(result.format, "ROS camera_info");
    expect_size_and_matrix(result.camera);
    EXPECT_EQ(result.camera.k3, .5);
    EXPECT_THAT(result.notes, IsEmpty());
  }
}

TEST(CameraInfoAsPrinted, OfAPartOfTheImageIsRefused) {
  EXPECT_THAT(error_of(with(kRos2Echo, "binning_x: 0", "binning_x: 2")), HasSubstr("binning_x is 2"));
  EXPECT_THAT(error_of(with(kRos2Echo, "x_offset: 0", "x_offset: 8")), HasSubstr("subtract the offset"));
  EXPECT_EQ(error_of(with(kRos2Echo, "  height: 0\n  width: 0", "  height: 48\n  width: 64")), "");
}

TEST(CameraInfoAsPrinted, OfADriverWithoutACalibrationIsRefused) {
  std::string text = kRos2Echo;
  for (const char* number : {"50.0", "32.0", "51.0", "24.0", "1.0\nr:"})
    text = with(text, std::string("- ") + number, number == std::string("1.0\nr:") ? "- 0.0\nr:" : "- 0.0");
  EXPECT_THAT(error_of(text), AllOf(HasSubstr("k is all zero"), HasSubstr("calibrate")));
}

constexpr const char* kOpenCv =
    "%YAML:1.0\n---\ncalibration_time: \"now\"\nimage_width: 64\nimage_height: 48\ncamera_matrix: !!opencv-matrix\n"
    "   rows: 3\n   cols: 3\n   dt: d\n   data: [ 50., 0., 32., 0., 51., 24., 0., 0., 1. ]\n"
    "distortion_coefficients: !!opencv-matrix\n   rows: 5\n   cols: 1\n   dt: d\n   data: [ 0.1, 0.2, 0.3, 0.4, 0.5 ]\n"
    "avg_reprojection_error: 0.21\n";

TEST(CameraOfOpenCv, ASmallSkewIsLeftOutAndTold) {
  const CameraFileResult result = parse(with(kOpenCv, "50., 0.,", "50., 0.083,"));
  ASSERT_EQ(result.error, "");
  expect_size_and_matrix(result.camera);
  EXPECT_THAT(result.notes, ElementsAre(HasSubstr("0.083")));
  EXPECT_THAT(error_of(with(kOpenCv, "50., 0.,", "50., 2.5,")),
              AllOf(HasSubstr("skew of 2.5 px"), HasSubstr("undistort")));
  EXPECT_THAT(parse(kOpenCv).notes, IsEmpty());
}

TEST(CameraOfOpenCv, MayHaveListsOfRows) {
  const CameraFileResult result = parse(
      "image_size: [64, 48]\ncamera_matrix: [[50, 0, 32], [0, 51, 24], [0, 0, 1]]\ndist_coeff: [[0.1, 0.2, 0.3, 0.4, "
      "0.5]]\n");
  ASSERT_EQ(result.error, "");
  expect_size_and_matrix(result.camera);
  EXPECT_EQ(result.camera.k3, .5);
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
    const CameraFileResult result = read_camera_file(file);
    ASSERT_EQ(result.error, "");
    EXPECT_EQ(result.format, "OpenCV");
    expect_size_and_matrix(result.camera);
    EXPECT_EQ(result.camera.k3, .5);
  }
  EXPECT_THAT(read_camera_file(write("d.xml", "<?xml version=\"1.0\"?><opencv_storage><image_width>64</")).error,
              HasSubstr("d.xml"));
  EXPECT_THAT(read_camera_file(write("m.xml", "<?xml version=\"1.0\"?><calibration><f>1</f></calibration>")).error,
              HasSubstr("XML"));
}

constexpr const char* kRealSense =
    "Device info:\n    Name : Intel RealSense\n\nIntrinsic Parameters:\n\n"
    " Intrinsic of \"Depth\" / 64x48 / {Z16}\n  Width:\t64\n  Height:\t48\n  PPX:\t31\n  PPY:\t23\n  Fx:\t40\n  "
    "Fy:\t40\n"
    "  Distortion:\tBrown Conrady\n  Coeffs:\t0  \t0  \t0  \t0  \t0\n  FOV (deg):\t62 x 49\n\n"
    " Intrinsic of \"Color\" / 128x72 / {YUYV}\n  Width:\t128\n  Height:\t72\n  PPX:\t64\n  PPY:\t36\n  Fx:\t100\n  "
    "Fy:\t102\n"
    "  Distortion:\tInverse Brown Conrady\n  Coeffs:\t0  \t0  \t0  \t0  \t0\n\n"
    " Intrinsic of \"Color\" / 64x48 / {YUYV}\r\n  Width:\t64\r\n  Height:\t48\r\n  PPX:\t32\r\n  PPY:\t24\r\n  "
    "Fx:\t50\r\n"
    "  Fy:\t51\r\n  Distortion:\tInverse Brown Conrady\r\n  Coeffs:\t0  \t0  \t0  \t0  \t0\r\n  FOV (deg):\t62 x "
    "49\r\n\n"
    "Motion Intrinsic Parameters:\n\nMotion Intrinsic of \"Gyro\":\n  Bias Variances: 0 0 0\n";

TEST_F(CameraFiles, OfRealSenseAreListingsOfAllSizes) {
  const std::string file = write("d435.txt", kRealSense);
  CameraFileResult result = read_camera_file(file);
  ASSERT_EQ(result.error, "");
  EXPECT_EQ(result.lens, "Color");
  choose_size(64, 48, &result);
  EXPECT_EQ(result.name, "Color 64x48");
  expect_size_and_matrix(result.camera);
  EXPECT_EQ(result.others.size(), 2u);
  EXPECT_EQ(read_camera_file(file + ":depth").camera.fx, 40);
  EXPECT_EQ(read_camera_file(file + ":Color 64x48").camera.fx, 50);
  EXPECT_THAT(read_camera_file(write("l.txt", "Device info:\n  Name : Intel RealSense D435\n")).error,
              HasSubstr("rs-enumerate-devices -c"));
}

TEST_F(CameraFiles, OfRealSenseWithALensThatWeDoNotHaveAreRefused) {
  const std::string only =
      std::string(kRealSense).substr(std::string(kRealSense).find(" Intrinsic of \"Color\" / 128x72"));
  const std::string file = write("c.txt", with(only, "Coeffs:\t0", "Coeffs:\t0.13"));
  EXPECT_THAT(read_camera_file(file).error,
              AllOf(HasSubstr("Distortion is 'Inverse Brown Conrady'"), HasSubstr("calibrate")));
  const CameraFileResult brown =
      read_camera_file(write("b.txt", with(with(only, "Inverse Brown", "Brown"), "Coeffs:\t0  \t0  \t0  \t0  \t0",
                                           "Coeffs:\t0.1 0.2 0.3 0.4 0.5")));
  ASSERT_EQ(brown.error, "");
  EXPECT_EQ(std::tie(brown.camera.k1, brown.camera.k3), std::make_tuple(.1, .5));
  const CameraFileResult fisheye =
      read_camera_file(write("f.txt", with(with(only, "Inverse Brown Conrady", "Kannala Brandt4"),
                                           "Coeffs:\t0  \t0  \t0  \t0  \t0", "Coeffs:\t0.1 0.2 0.3 0.4 0")));
  ASSERT_EQ(fisheye.error, "");
  EXPECT_EQ(fisheye.camera.k4, .4);
}

TEST_F(CameraFiles, OfColmapAreShiftedByHalfAPixel) {
  const std::string file =
      write("cameras.txt",
            "# Camera list with one line of data per camera:\n# Number of cameras: 4\n"
            "1 OPENCV 64 48 50 51 32.5 24.5 0.1 0.2 0.3 0.4\n2 SIMPLE_RADIAL 64 48 50 32.5 24.5 0.7\n"
            "3 OPENCV_FISHEYE 64 48 50 51 32.5 24.5 0.1 0.2 0.3 0.4\n4 FOV 64 48 50 51 32.5 24.5 0.9\n");
  const CameraFileResult first = read_camera_file(file);
  ASSERT_EQ(first.error, "");
  EXPECT_EQ(first.format, "COLMAP");
  expect_size_and_matrix(first.camera);
  EXPECT_EQ(std::tie(first.camera.k2, first.camera.p2), std::make_tuple(.2, .4));
  EXPECT_EQ(read_camera_file(file + ":2").camera.k1, .7);
  EXPECT_EQ(read_camera_file(file + ":3").camera.k4, .4);
  EXPECT_THAT(read_camera_file(file + ":4").error, HasSubstr("'FOV'"));
}

TEST(CameraOfOpenCv, NeedsNoSpaceBehindAColon) {
  const std::string text = with(with(kOpenCv, "data: [ 50.", "data:[ 50."), "image_width: 64", "image_width:64");
  EXPECT_EQ(error_of(text), "");
  expect_size_and_matrix(parse(text).camera);
}

TEST(CameraOfOpenCv, MayBeAGroup) {
  const std::string camera =
      "image_width: 64, image_height: 48, camera_matrix: [50, 0, 32, 0, 51, 24, 0, 0, 1], distortion_coefficients: [0, "
      "0, 0, 0]";
  const CameraFileResult result = parse(fmt::format("camera0: {{{0}}}\ncamera1: {{{0}}}\n", camera));
  ASSERT_EQ(result.error, "");
  EXPECT_EQ(result.name, "camera0");
  expect_size_and_matrix(result.camera);
  EXPECT_EQ(result.others.size(), 1u);
}

TEST(CameraOfCamodocal, IsReadOrRefusedByItsModel) {
  const std::string pinhole =
      "%YAML:1.0\n---\nmodel_type: PINHOLE\ncamera_name: camera\nimage_width: 64\nimage_height: 48\n"
      "distortion_parameters:\n   k1: 0.1\n   k2: 0.2\n   p1: 0.3\n   p2: 0.4\n"
      "projection_parameters:\n   fx: 50\n   fy: 51\n   cx: 32\n   cy: 24\n";
  CameraFileResult result = parse(pinhole);
  ASSERT_EQ(result.error, "");
  expect_size_and_matrix(result.camera);
  EXPECT_EQ(result.camera.p2, .4);
  result = parse(
      "model_type: KANNALA_BRANDT\nimage_width: 64\nimage_height: 48\nprojection_parameters:\n   k2: 0.1\n   k3: 0.2\n"
      "   k4: 0.3\n   k5: 0.4\n   mu: 50\n   mv: 51\n   u0: 32\n   v0: 24\n");
  ASSERT_EQ(result.error, "");
  expect_size_and_matrix(result.camera);
  EXPECT_EQ(std::tie(result.camera.k1, result.camera.k4), std::make_tuple(.1, .4));
  EXPECT_THAT(error_of(with(pinhole, "PINHOLE", "MEI")), HasSubstr("model_type is 'MEI'"));
}

TEST(CamerasOfBasaltAndDepthAi, AreReadByTheirNames) {
  const CameraFileResult basalt = parse(
      "{\"value0\": {\"T_imu_cam\": [{\"px\": 0, \"qw\": 1}, {\"px\": 0.1, \"qw\": 1}], \"intrinsics\": "
      "[{\"camera_type\": \"kb4\", "
      "\"intrinsics\": {\"fx\": 50, \"fy\": 51, \"cx\": 32, \"cy\": 24, \"k1\": 0.1, \"k2\": 0.2, \"k3\": 0.3, \"k4\": "
      "0.4}}, "
      "{\"camera_type\": \"ds\", \"intrinsics\": {\"fx\": 50, \"fy\": 51, \"cx\": 32, \"cy\": 24, \"xi\": 0.1, "
      "\"alpha\": 0.2}}], "
      "\"resolution\": [[64, 48], [64, 48]], \"vignette\": []}}");
  ASSERT_EQ(basalt.error, "");
  EXPECT_EQ(basalt.format, "Basalt");
  expect_size_and_matrix(basalt.camera);
  EXPECT_EQ(basalt.camera.k4, .4);
  EXPECT_THAT(basalt.others, IsEmpty());
  const std::string depthai =
      "{\"cameraData\": [[0, {\"cameraType\": 0, \"distortionCoeff\": [0.1, 0.2, 0.3, 0.4, 0.5, 0, 0, 0, 0, 0, 0, 0, "
      "0, 0], "
      "\"height\": 48, \"width\": 64, \"intrinsicMatrix\": [[50, 0, 32], [0, 51, 24], [0, 0, 1]], \"extrinsics\": "
      "{\"toCameraSocket\": "
      "1}}]]}";
  const CameraFileResult read = parse(depthai);
  ASSERT_EQ(read.error, "");
  EXPECT_EQ(read.name, "CAM_A");
  expect_size_and_matrix(read.camera);
  EXPECT_THAT(error_of(with(depthai, "0.5, 0,", "0.5, 8.1,")), HasSubstr("(k4) is 8.1"));
}

constexpr const char* kTransforms =
    R"({"camera_model": "OPENCV", "fl_x": 50, "fl_y": 51.0, "cx": 32.5, "cy": 24.5, "w": 64, "h": 48.0, "k1": 0.1,
 "k2": 0.2, "p1": 0.3, "p2": 0.4, "aabb_scale": 16, "colour_space": "srgb",
 "frames": [{"file_path": "images/1.png", "transform_matrix": [[1, 0, 0, 0], [0, 1, 0, 0]]}]})";

TEST_F(CameraFiles, OfNerfAreReadWithoutTheirFrames) {
  std::string text = kTransforms;
  // More of them than a calibration may have bytes.
  std::string frames;
  for (int i = 0; i < 2000; ++i) frames += R"({"file_path": "images/1.png", "transform_matrix": [[1, 0, 0, 0]]}, )";
  const CameraFileResult result = read_camera_file(write("transforms.json", with(text, "[{", "[" + frames + "{")));
  ASSERT_EQ(result.error, "");
  EXPECT_EQ(result.format, "transforms.json");
  expect_size_and_matrix(result.camera);
  EXPECT_EQ(std::tie(result.camera.k1, result.camera.p2), std::make_tuple(.1, .4));
  EXPECT_THAT(result.notes, ElementsAre(AllOf(HasSubstr("not used of it: "), HasSubstr("colour_space"))));
  text = with(with(text, "\"OPENCV\"", "\"OPENCV_FISHEYE\""), "\"p1\": 0.3, \"p2\": 0.4", "\"k3\": 0.3, \"k4\": 0.4");
  EXPECT_EQ(read_camera_file(write("fisheye.json", text)).camera.k4, .4);
}

TEST_F(CameraFiles, OfNerfMayBeNestedAsDeepAsTheyLike) {
  const std::string deep = std::string(500'000, '[') + std::string(500'000, ']');
  const CameraFileResult read = read_camera_file(write("deep.json", with(kTransforms, "\"srgb\"", deep)));
  EXPECT_EQ(read.error, "");
  EXPECT_EQ(read.camera.fx, 50);
}

TEST_F(CameraFiles, OfNerfMayHaveOnlyAnAngle) {
  const std::string frames = R"("frames": [{"file_path": "r_0"}]})";
  const std::string angle = R"({"camera_angle_x": 1.5707963267948966, )" + frames;
  const CameraFileResult read =
      read_camera_file(write("a.json", R"({"camera_angle_x": 1.5707963267948966, "w": 64, "h": 48, )" + frames));
  ASSERT_EQ(read.error, "");
  EXPECT_NEAR(read.camera.fx, 32, 1e-9);
  EXPECT_EQ(std::tie(read.camera.fy, read.camera.cx, read.camera.cy), std::make_tuple(read.camera.fx, 31.5, 23.5));
  EXPECT_THAT(read.notes, Contains(HasSubstr("cx is not there")));
  EXPECT_THAT(read_camera_file(write("b.json", angle)).error, AllOf(HasSubstr("add w and h"), HasSubstr("0.5 times")));
}

TEST_F(CameraFiles, OfNerfMayHaveTheCameraWithEachImage) {
  const std::string camera = R"("fl_x": 50, "fl_y": 51, "cx": 32.5, "cy": 24.5, "w": 64, "h": 48})";
  const std::string text = R"({"frames": [{"file_path": "1", )" + camera + R"(, {"file_path": "2", )" + camera + "]}";
  const CameraFileResult read = read_camera_file(write("a.json", text));
  ASSERT_EQ(read.error, "");
  expect_size_and_matrix(read.camera);
  EXPECT_THAT(read_camera_file(write("b.json", with(text, "50", "60"))).error, HasSubstr("they differ"));
  EXPECT_THAT(read_camera_file(write("c.json", text.substr(0, 90))).error, HasSubstr("cut off"));
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

// Anchors make a list of a few bytes as long as they like.
TEST(CameraOfGyroflow, IsAFisheyeInTheSizeOfItsCalibration) {
  const std::string profile =
      R"({"name":"a","calib_dimension":{"w":64,"h":48},"orig_dimension":{"w":128,"h":96},"fisheye_params":{"RMS_error":0.5,)"
      R"("camera_matrix":[[50,0,32],[0,51,24],[0,0,1]],"distortion_coeffs":[0.03,0.02,-0.01,0.002]}})";
  const CameraFileResult result = parse(profile);
  EXPECT_EQ(result.error, "");
  EXPECT_EQ(result.camera.model, Camera::Model::kKannalaBrandt);
  expect_size_and_matrix(result.camera);
  EXPECT_EQ(result.camera.k4, 0.002);
  EXPECT_THAT(error_of(with(profile, "\"name\"", "\"distortion_model\":\"poly5\",\"name\"")), HasSubstr("'poly5'"));
  EXPECT_THAT(error_of(with(profile, "\"RMS", "\"image_width\":640,\"RMS")), HasSubstr("calib_dimension is 64 x 48"));
}

TEST(CameraOfAFisheye, IsNeverTakenForAPinhole) {
  const std::string text =
      "camera_matrix: [50, 0, 32, 0, 51, 24, 0, 0, 1]\ndist_coeffs: [0.1, 0.2, 0.01, 0.02]\nimage_width: 64\n"
      "image_height: 48\n";
  EXPECT_EQ(error_of(text), "");
  EXPECT_EQ(error_of(text + "is_fisheye: false\n"), "");
  EXPECT_EQ(parse(text + "fisheye_model: 1\n").camera.model, Camera::Model::kKannalaBrandt);
  for (const char* sign : {"is_fisheye: true\n", "camera_model: fisheye\n", "model: Equidistant\n"})
    EXPECT_THAT(error_of(text + sign), HasSubstr("fisheye_model: 1")) << sign;
  EXPECT_THAT(
      error_of("fisheye_left:\n  camera_matrix: [50, 0, 32, 0, 51, 24, 0, 0, 1]\n  dist_coeffs: [0.1, 0.2, 0.01, "
               "0.02]\n  image_width: 64\n  image_height: 48\n"),
      HasSubstr("fisheye"));
}

TEST(CameraOfOrbSlam, OfTheRationalModelIsRefusedAsThat) {
  EXPECT_THAT(error_of(std::string(kOpenVslam) + "Camera.k4: 0.4\nCamera.k5: 0.1\nCamera.k6: 0.2\n"),
              AllOf(HasSubstr("Camera.k4 is 0.4: the rational model"), Not(HasSubstr("fisheye"))));
}

TEST(CameraOfDso, IsRefusedWithWhatToWrite) {
  EXPECT_THAT(
      error_of("0.5 0.75 0.5 0.5 0\n640 480\ncrop\n640 480\n"),
      HasSubstr("DSO, which is not read: write fx: 320, fy: 360, cx: 319.5, cy: 239.5, width: 640, height: 480"));
  EXPECT_THAT(error_of("0.53 0.66 0.49 0.50 0.89\n640 480\ncrop\n640 480\n"), HasSubstr("DSO with its model FOV"));
  EXPECT_THAT(error_of("Pinhole 500 501 320 240 0\n640 480\ncrop\n640 480\n"), HasSubstr("fx: 500, fy: 501, cx: 320"));
  EXPECT_THAT(error_of("RadTan 500 501 320 240 -0.2 0.1 0 0\n640 480\ncrop\n640 480\n"),
              HasSubstr("k1: -0.2, k2: 0.1"));
  EXPECT_THAT(error_of("KannalaBrandt 500 501 320 240 -0.2 0.1 0 0\n640 480\ncrop\n640 480\n"),
              HasSubstr("model: fisheye, k1: -0.2"));
}

TEST(CameraWhoseLensFolds, IsRefused) {
  const std::string wide = "fx: 380\nfy: 380\ncx: 320\ncy: 240\nwidth: 640\nheight: 480\n";
  EXPECT_EQ(error_of(wide + "k1: -0.28\nk2: 0.074\n"), "");
  EXPECT_EQ(error_of(wide + "k1: 0.26\nk2: -0.95\nk3: 1.16\n"), "");
  EXPECT_THAT(error_of(wide + "k1: -0.9\nk2: 0.9\nk3: -5.3\n"),
              AllOf(HasSubstr("folds the image"), HasSubstr("k1 = -0.9, k2 = 0.9, k3 = -5.3"),
                    HasSubstr("pixels from cx, cy")));
  EXPECT_THAT(error_of(wide + "k1: -20\n"), HasSubstr("folds the image"));
  EXPECT_THAT(error_of(wide + "model: fisheye\nk1: -20\n"), HasSubstr("folds the image"));
  const std::string far = "fx: 1200\nfy: 1200\ncx: 320\ncy: 240\nwidth: 640\nheight: 480\n";
  EXPECT_EQ(error_of(far + "k1: -0.9\nk2: 0.9\nk3: -5.3\n"), "") << "where nobody looks";
}

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
