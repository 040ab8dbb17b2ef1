// SPDX-License-Identifier: BSD-3-Clause
// Tests the reading of a camera_info, as `ros2 topic echo` prints it.
#include <gmock/gmock.h>

#include "tests/formats/camera/foreign_camera.h"

namespace rumi {
namespace {

using ::testing::AllOf;
using testing::error_of;
using testing::expect_size_and_matrix;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::parse;
using testing::with;

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
    const Result<CameraFile> result = parse(text);
    ASSERT_EQ(result.error_text(), "");
    EXPECT_EQ(result->format, "ROS camera_info");
    expect_size_and_matrix(result->camera);
    EXPECT_EQ(result->camera.k3, .5);
    EXPECT_THAT(result->notes, IsEmpty());
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

}  // namespace
}  // namespace rumi
