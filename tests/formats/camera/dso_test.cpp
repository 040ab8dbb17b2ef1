// SPDX-License-Identifier: BSD-3-Clause
// Tests that DSO's camera files are refused, with the lines that the user must write instead.
#include <gmock/gmock.h>

#include "tests/formats/camera/foreign_camera.h"

namespace rumi {
namespace {

using testing::error_of;
using ::testing::HasSubstr;
using testing::with;

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

}  // namespace
}  // namespace rumi
