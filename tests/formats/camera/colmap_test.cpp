// SPDX-License-Identifier: BSD-3-Clause
// Tests the reading of COLMAP's cameras.txt.
#include <gmock/gmock.h>

#include "tests/formats/camera/foreign_camera.h"

namespace rumi {
namespace {

using testing::CameraFiles;
using testing::expect_size_and_matrix;
using ::testing::HasSubstr;
using testing::with;

TEST_F(CameraFiles, OfColmapAreShiftedByHalfAPixel) {
  const std::string file =
      write("cameras.txt",
            "# Camera list with one line of data per camera:\n# Number of cameras: 4\n"
            "1 OPENCV 64 48 50 51 32.5 24.5 0.1 0.2 0.3 0.4\n2 SIMPLE_RADIAL 64 48 50 32.5 24.5 0.7\n"
            "3 OPENCV_FISHEYE 64 48 50 51 32.5 24.5 0.1 0.2 0.3 0.4\n4 FOV 64 48 50 51 32.5 24.5 0.9\n");
  const Result<CameraFile> first = read_camera_file(file);
  ASSERT_EQ(first.error_text(), "");
  EXPECT_EQ(first->format, "COLMAP");
  expect_size_and_matrix(first->camera);
  EXPECT_EQ(std::tie(first->camera.k2, first->camera.p2), std::make_tuple(.2, .4));
  EXPECT_EQ(read_camera_file(file + ":2").value().camera.k1, .7);
  EXPECT_EQ(read_camera_file(file + ":3").value().camera.k4, .4);
  EXPECT_THAT(read_camera_file(file + ":4").error_text(), HasSubstr("'FOV'"));
}

}  // namespace
}  // namespace rumi
