// SPDX-License-Identifier: BSD-3-Clause
// Tests the reading of what `rs-enumerate-devices -c` lists.
#include <gmock/gmock.h>

#include "tests/formats/camera/foreign_camera.h"

namespace rumi {
namespace {

using ::testing::AllOf;
using testing::CameraFiles;
using testing::expect_size_and_matrix;
using ::testing::HasSubstr;
using testing::with;

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
  Result<CameraFile> result = read_camera_file(file);
  ASSERT_EQ(result.error_text(), "");
  EXPECT_EQ(result->lens, "Color");
  choose_size(64, 48, &*result);
  EXPECT_EQ(result->name, "Color 64x48");
  expect_size_and_matrix(result->camera);
  EXPECT_EQ(result->others.size(), 2u);
  EXPECT_EQ(read_camera_file(file + ":depth").value().camera.fx, 40);
  EXPECT_EQ(read_camera_file(file + ":Color 64x48").value().camera.fx, 50);
  EXPECT_THAT(read_camera_file(write("l.txt", "Device info:\n  Name : Intel RealSense D435\n")).error_text(),
              HasSubstr("rs-enumerate-devices -c"));
}

TEST_F(CameraFiles, OfRealSenseWithALensThatWeDoNotHaveAreRefused) {
  const std::string only =
      std::string(kRealSense).substr(std::string(kRealSense).find(" Intrinsic of \"Color\" / 128x72"));
  const std::string file = write("c.txt", with(only, "Coeffs:\t0", "Coeffs:\t0.13"));
  EXPECT_THAT(read_camera_file(file).error_text(),
              AllOf(HasSubstr("Distortion is 'Inverse Brown Conrady'"), HasSubstr("calibrate")));
  const Result<CameraFile> brown =
      read_camera_file(write("b.txt", with(with(only, "Inverse Brown", "Brown"), "Coeffs:\t0  \t0  \t0  \t0  \t0",
                                           "Coeffs:\t0.1 0.2 0.3 0.4 0.5")));
  ASSERT_EQ(brown.error_text(), "");
  EXPECT_EQ(std::tie(brown->camera.k1, brown->camera.k3), std::make_tuple(.1, .5));
  const Result<CameraFile> fisheye =
      read_camera_file(write("f.txt", with(with(only, "Inverse Brown Conrady", "Kannala Brandt4"),
                                           "Coeffs:\t0  \t0  \t0  \t0  \t0", "Coeffs:\t0.1 0.2 0.3 0.4 0")));
  ASSERT_EQ(fisheye.error_text(), "");
  EXPECT_EQ(fisheye->camera.k4, .4);
}

}  // namespace
}  // namespace rumi
