// SPDX-License-Identifier: BSD-3-Clause
// Tests the reading of Kalibr's camchains.
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
using testing::kOrbSlam;
using testing::with;

constexpr const char* kCamchain =
    "cam0:\n  cam_overlaps: [1]\n  camera_model: pinhole\n  distortion_coeffs: [0.1, 0.2, 0.3, 0.4]\n"
    "  distortion_model: radtan\n  intrinsics: [70, 71, 40, 30]\n  resolution: [80, 60]\n  rostopic: /left\n"
    "cam1:\n  T_cn_cnm1:\n  - [1.0, 0.0, 0.0, -0.11]\n  - [0.0, 1.0, 0.0, 0.0]\n  - [0.0, 0.0, 1.0, 0.0]\n"
    "  - [0.0, 0.0, 0.0, 1.0]\n  camera_model: pinhole\n  distortion_coeffs: [0, 0, 0, 0]\n  distortion_model: radtan\n"
    "  intrinsics: [50, 51, 32, 24]\n  resolution: [64, 48]\n  rostopic: /right\n";

TEST_F(CameraFiles, OfKalibrNameTheirCameras) {
  const std::string file = write("camchain.yaml", kCamchain);
  const Result<CameraFile> first = read_camera_file(file);
  ASSERT_EQ(first.error_text(), "");
  EXPECT_EQ(first->camera.width, 80);
  EXPECT_THAT(first->notes, ElementsAre(AllOf(HasSubstr("cam0, cam1"), HasSubstr("cam0 is taken"))));
  EXPECT_THAT(advice_on_size(*first, 64, 48), HasSubstr("give --camera " + file + ":cam1"));
  const Result<CameraFile> second = read_camera_file(file + ":cam1");
  ASSERT_EQ(second.error_text(), "");
  expect_size_and_matrix(second->camera);
  EXPECT_THAT(second->notes, IsEmpty());
  EXPECT_THAT(read_camera_file(file + ":cam7").error_text(),
              AllOf(HasSubstr("no camera 'cam7'"), HasSubstr("cam0, cam1")));
  EXPECT_THAT(read_camera_file(write("one.yaml", kOrbSlam) + ":cam1").error_text(), HasSubstr("has one camera only"));
  EXPECT_THAT(read_camera_file((folder_.path() / "no.yaml:cam1").string()).error_text(),
              HasSubstr("no.yaml:cam1: no such file"));
}

TEST_F(CameraFiles, MayHaveAColonInTheirName) {
  write("rig.yaml", kCamchain);
  const Result<CameraFile> result = read_camera_file(write("rig.yaml:cam1", with(kCamchain, "[80, 60]", "[100, 60]")));
  ASSERT_EQ(result.error_text(), "");
  EXPECT_EQ(result->camera.width, 100);
}

TEST_F(CameraFiles, OfKalibrAreRefusedByTheCameraThatIsAskedFor) {
  const std::string file = write("c.yaml", with(kCamchain, "camera_model: pinhole", "camera_model: omni"));
  EXPECT_THAT(read_camera_file(file).error_text(),
              AllOf(HasSubstr("cam0.camera_model is 'omni'"), HasSubstr(file + ":cam1")));
  EXPECT_EQ(read_camera_file(file + ":cam1").error_text(), "");
  EXPECT_THAT(error_of(with(kCamchain, "  distortion_model: radtan\n", "")),
              HasSubstr("cam0.distortion_model is none or missing"));
}

}  // namespace
}  // namespace rumi
