// SPDX-License-Identifier: BSD-3-Clause
// Tests the reading of Gyroflow's lens profiles.
#include <gmock/gmock.h>

#include "tests/formats/camera/foreign_camera.h"

namespace rumi {
namespace {

using testing::error_of;
using testing::expect_size_and_matrix;
using ::testing::HasSubstr;
using testing::parse;
using testing::with;

TEST(CameraOfGyroflow, IsAFisheyeInTheSizeOfItsCalibration) {
  const std::string profile =
      R"({"name":"a","calib_dimension":{"w":64,"h":48},"orig_dimension":{"w":128,"h":96},"fisheye_params":{"RMS_error":0.5,)"
      R"("camera_matrix":[[50,0,32],[0,51,24],[0,0,1]],"distortion_coeffs":[0.03,0.02,-0.01,0.002]}})";
  const Result<CameraFile> result = parse(profile);
  EXPECT_EQ(result.error_text(), "");
  EXPECT_EQ(result->camera.model, Camera::Model::kKannalaBrandt);
  expect_size_and_matrix(result->camera);
  EXPECT_EQ(result->camera.k4, 0.002);
  EXPECT_THAT(error_of(with(profile, "\"name\"", "\"distortion_model\":\"poly5\",\"name\"")), HasSubstr("'poly5'"));
  EXPECT_THAT(error_of(with(profile, "\"RMS", "\"image_width\":640,\"RMS")), HasSubstr("calib_dimension is 64 x 48"));
}

}  // namespace
}  // namespace rumi
