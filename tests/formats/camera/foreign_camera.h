// SPDX-License-Identifier: BSD-3-Clause
// Shared by the tests of other tools' camera files: a small camera, as a text or in a file.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <tuple>

#include "formats/camera/camera_file.h"
#include "formats/camera/formats.h"
#include "tests/support/temporary_folder.h"

namespace rumi::testing {

inline Result<CameraFile> parse(const std::string& text) { return parse_camera(text, "c.yaml"); }
inline std::string error_of(const std::string& text) { return parse(text).error_text(); }

inline void expect_size_and_matrix(const Camera& c) {
  EXPECT_EQ(std::tie(c.width, c.height, c.fx, c.fy, c.cx, c.cy), std::make_tuple(64, 48, 50., 51., 32., 24.));
}

inline constexpr const char* kOpenVslam =
    "Camera.name: \"a camera\"\nCamera.setup: \"monocular\"\nCamera.model: \"perspective\"\nCamera.fx: 50.0\n"
    "Camera.fy: 51.0\nCamera.cx: 32.0\nCamera.cy: 24.0\nCamera.k1: 0.1\nCamera.k2: 0.2\nCamera.p1: 0.3\n"
    "Camera.p2: 0.4\nCamera.k3: 0.5\nCamera.fps: 30.0\nCamera.cols: 64\nCamera.rows: 48\nCamera.color_order: \"RGB\"\n"
    "Feature.max_num_keypoints: 1000\n";

inline constexpr const char* kOrbSlam =
    "%YAML:1.0\nFile.version: \"1.0\"\nCamera.type: \"PinHole\"\nCamera1.fx: 50.0\nCamera1.fy: 51.0\nCamera1.cx: 32.0\n"
    "Camera1.cy: 24.0\nCamera1.k1: 0.1\nCamera1.k2: 0.2\nCamera1.p1: 0.3\nCamera1.p2: 0.4\nCamera.width: 64\n"
    "Camera.height: 48\nCamera.fps: 30\nCamera.RGB: 1\nORBextractor.nFeatures: 1200\n";

// Returns `text` with one piece of it replaced.
inline std::string with(std::string text, const std::string& piece, const std::string& other) {
  const size_t at = text.find(piece);
  EXPECT_NE(at, std::string::npos) << piece;
  return text.replace(at, piece.size(), other);
}

class CameraFiles : public ::testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& text) { return folder_.write(name, text); }
  TemporaryFolder folder_;
};

}  // namespace rumi::testing
