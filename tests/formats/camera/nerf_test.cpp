// SPDX-License-Identifier: BSD-3-Clause
// Tests the reading of transforms.json, as NeRF programs write it.
#include <gmock/gmock.h>

#include "tests/formats/camera/foreign_camera.h"

namespace rumi {
namespace {

using ::testing::AllOf;
using testing::CameraFiles;
using ::testing::Contains;
using ::testing::ElementsAre;
using testing::expect_size_and_matrix;
using ::testing::HasSubstr;
using testing::with;

constexpr const char* kTransforms =
    R"({"camera_model": "OPENCV", "fl_x": 50, "fl_y": 51.0, "cx": 32.5, "cy": 24.5, "w": 64, "h": 48.0, "k1": 0.1,
 "k2": 0.2, "p1": 0.3, "p2": 0.4, "aabb_scale": 16, "colour_space": "srgb",
 "frames": [{"file_path": "images/1.png", "transform_matrix": [[1, 0, 0, 0], [0, 1, 0, 0]]}]})";

TEST_F(CameraFiles, OfNerfAreReadWithoutTheirFrames) {
  std::string text = kTransforms;
  // The frames take more bytes than a calibration may have.
  std::string frames;
  for (int i = 0; i < 2000; ++i) frames += R"({"file_path": "images/1.png", "transform_matrix": [[1, 0, 0, 0]]}, )";
  const Result<CameraFile> result = read_camera_file(write("transforms.json", with(text, "[{", "[" + frames + "{")));
  ASSERT_EQ(result.error_text(), "");
  EXPECT_EQ(result->format, "transforms.json");
  expect_size_and_matrix(result->camera);
  EXPECT_EQ(std::tie(result->camera.k1, result->camera.p2), std::make_tuple(.1, .4));
  EXPECT_THAT(result->notes, ElementsAre(AllOf(HasSubstr("not used of it: "), HasSubstr("colour_space"))));
  text = with(with(text, "\"OPENCV\"", "\"OPENCV_FISHEYE\""), "\"p1\": 0.3, \"p2\": 0.4", "\"k3\": 0.3, \"k4\": 0.4");
  EXPECT_EQ(read_camera_file(write("fisheye.json", text)).value().camera.k4, .4);
}

TEST_F(CameraFiles, OfNerfMayBeNestedAsDeepAsTheyLike) {
  const std::string deep = std::string(500'000, '[') + std::string(500'000, ']');
  const Result<CameraFile> read = read_camera_file(write("deep.json", with(kTransforms, "\"srgb\"", deep)));
  EXPECT_EQ(read.error_text(), "");
  EXPECT_EQ(read->camera.fx, 50);
}

TEST_F(CameraFiles, OfNerfMayHaveOnlyAnAngle) {
  const std::string frames = R"("frames": [{"file_path": "r_0"}]})";
  const std::string angle = R"({"camera_angle_x": 1.5707963267948966, )" + frames;
  const Result<CameraFile> read =
      read_camera_file(write("a.json", R"({"camera_angle_x": 1.5707963267948966, "w": 64, "h": 48, )" + frames));
  ASSERT_EQ(read.error_text(), "");
  EXPECT_NEAR(read->camera.fx, 32, 1e-9);
  EXPECT_EQ(std::tie(read->camera.fy, read->camera.cx, read->camera.cy), std::make_tuple(read->camera.fx, 31.5, 23.5));
  EXPECT_THAT(read->notes, Contains(HasSubstr("cx is not there")));
  EXPECT_THAT(read_camera_file(write("b.json", angle)).error_text(),
              AllOf(HasSubstr("add w and h"), HasSubstr("0.5 times")));
}

TEST_F(CameraFiles, OfNerfMayHaveTheCameraWithEachImage) {
  const std::string camera = R"("fl_x": 50, "fl_y": 51, "cx": 32.5, "cy": 24.5, "w": 64, "h": 48})";
  const std::string text = R"({"frames": [{"file_path": "1", )" + camera + R"(, {"file_path": "2", )" + camera + "]}";
  const Result<CameraFile> read = read_camera_file(write("a.json", text));
  ASSERT_EQ(read.error_text(), "");
  expect_size_and_matrix(read->camera);
  EXPECT_THAT(read_camera_file(write("b.json", with(text, "50", "60"))).error_text(), HasSubstr("they differ"));
  EXPECT_THAT(read_camera_file(write("c.json", text.substr(0, 90))).error_text(), HasSubstr("cut off"));
}

}  // namespace
}  // namespace rumi
