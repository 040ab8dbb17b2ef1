// SPDX-License-Identifier: BSD-3-Clause
// Tests camera files of ORB-SLAM and OpenVSLAM: all of a file is read, or it is refused with the name of the field that
// is not.
#include <gmock/gmock.h>

#include "tests/formats/camera/foreign_camera.h"

namespace rumi {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using testing::error_of;
using testing::expect_size_and_matrix;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::kOpenVslam;
using testing::kOrbSlam;
using ::testing::Not;
using testing::parse;
using testing::with;

TEST(CameraOfOpenVslam, IsReadWithItsColumnsAndRows) {
  const Result<CameraFile> result = parse(kOpenVslam);
  ASSERT_EQ(result.error_text(), "");
  EXPECT_EQ(result->format, "OpenVSLAM");
  expect_size_and_matrix(result->camera);
  EXPECT_EQ(std::tie(result->camera.k3, result->camera.p2, result->camera.fps), std::make_tuple(.5, .4, 30.));
  EXPECT_THAT(result->notes, IsEmpty());
}

TEST(CameraOfOpenVslam, IsReadAsAGroup) {
  const Result<CameraFile> result = parse(
      "Camera:\n  name: a\n  setup: monocular\n  model: perspective\n  fx: 50\n  fy: 51\n  cx: 32\n  cy: 24\n  k1: "
      "0.1\n"
      "  k2: 0\n  p1: 0\n  p2: 0\n  k3: 0\n  fps: 30.0\n  cols: 64\n  rows: 48\n  color_order: RGB\n"
      "Preprocessing:\n  min_size: 800\nFeature:\n  name: default\n");
  ASSERT_EQ(result.error_text(), "");
  expect_size_and_matrix(result->camera);
  EXPECT_THAT(result->notes, IsEmpty());
}

TEST(CameraOfOpenVslam, MayBeAFisheye) {
  const std::string fisheye =
      with(with(kOpenVslam, "perspective", "fisheye"), "Camera.p1: 0.3\nCamera.p2: 0.4\n", "Camera.k4: 0.6\n");
  const Result<CameraFile> result = parse(fisheye);
  ASSERT_EQ(result.error_text(), "");
  EXPECT_EQ(result->camera.model, Camera::Model::kKannalaBrandt);
  const Camera& c = result->camera;
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

TEST(CameraOfOrbSlam, IsReadWithoutAWordOnTheRest) {
  const Result<CameraFile> result = parse(kOrbSlam);
  ASSERT_EQ(result.error_text(), "");
  expect_size_and_matrix(result->camera);
  EXPECT_THAT(result->notes, IsEmpty());
}

TEST(CameraOfOrbSlam, RectifiedTellsWhatItLeavesOut) {
  const Result<CameraFile> result = parse(with(kOrbSlam, "PinHole", "Rectified"));
  ASSERT_EQ(result.error_text(), "");
  EXPECT_FALSE(result->camera.has_distortion());
  EXPECT_THAT(result->notes, ElementsAre(AllOf(HasSubstr("c.yaml"), HasSubstr("Camera1.k1 (0.1)"),
                                               HasSubstr("Camera1.p2 (0.4)"), HasSubstr("must be rectified"))));
}

TEST(CameraOfOrbSlam, TellsOfSizesThatItDoesNotUse) {
  EXPECT_THAT(parse(std::string(kOrbSlam) + "Camera.newWidth: 32\nCamera.newHeight: 48\n").value().notes,
              ElementsAre(HasSubstr("Camera.newWidth is '32'")));
  EXPECT_THAT(parse(std::string(kOrbSlam) + "Camera.imageScale: 0.5\n").value().notes,
              ElementsAre(HasSubstr("imageScale")));
  EXPECT_THAT(parse(std::string(kOrbSlam) + "Lens.maker: nobody\n").value().notes,
              ElementsAre(HasSubstr("Lens.maker")));
}

TEST(CameraOfOrbSlam, MayHaveASecondOne) {
  const std::string second = "Camera2.fx: 40\nCamera2.fy: 41\nCamera2.cx: 32\nCamera2.cy: 24\nCamera2.k1: 0.7\n";
  const Result<CameraFile> result = parse(kOrbSlam + second);
  ASSERT_EQ(result.error_text(), "");
  EXPECT_EQ(result->camera.fx, 50);
  ASSERT_EQ(result->others.size(), 1u);
  EXPECT_EQ(result->others[0].name, "Camera2");
  EXPECT_EQ(std::tie(result->others[0].camera.fx, result->others[0].camera.k1), std::make_tuple(40., .7));
}

TEST(CameraOfOrbSlam, MayHaveItsCoefficientsAsAList) {
  const std::string list =
      "%YAML:1.0\nCamera.fx: 50\nCamera.fy: 51\nCamera.cx: 32\nCamera.cy: 24\nCamera.width: 64\n"
      "Camera.height: 48\nDistCoef: !!opencv-matrix\n  rows: 4\n  cols: 1\n  dt: f\n"
      "  data: [0.1, 0.2, 0.3, 0.4]\n";
  const Result<CameraFile> result = parse(list);
  ASSERT_EQ(result.error_text(), "");
  EXPECT_EQ(std::tie(result->camera.k1, result->camera.p2), std::make_tuple(.1, .4));
}

TEST(CameraOfOrbSlam, OfTheRationalModelIsRefusedAsThat) {
  EXPECT_THAT(error_of(std::string(kOpenVslam) + "Camera.k4: 0.4\nCamera.k5: 0.1\nCamera.k6: 0.2\n"),
              AllOf(HasSubstr("Camera.k4 is 0.4: the rational model"), Not(HasSubstr("fisheye"))));
}

}  // namespace
}  // namespace rumi
