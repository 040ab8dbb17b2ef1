// SPDX-License-Identifier: BSD-3-Clause
// Tests calibrations whose distortion folds the image.
#include <gmock/gmock.h>

#include "tests/formats/camera/foreign_camera.h"

namespace rumi {
namespace {

using ::testing::AllOf;
using testing::error_of;
using ::testing::HasSubstr;

const std::string kWide = "fx: 380\nfy: 380\ncx: 320\ncy: 240\nwidth: 640\nheight: 480\n";

std::string notes_of(const std::string& text) {
  const Result<CameraFile> result = parse_camera(text, "camera.yaml");
  std::string all;
  for (const std::string& note : result->notes) all += note + "\n";
  return result.error_text() + all;
}

TEST(CameraWhoseLensFolds, IsRefusedWhereLittleIsLeft) {
  EXPECT_EQ(error_of(kWide + "k1: -0.28\nk2: 0.074\n"), "");
  EXPECT_EQ(error_of(kWide + "k1: 0.26\nk2: -0.95\nk3: 1.16\n"), "");
  EXPECT_THAT(
      error_of(kWide + "k1: -1.9\nk2: 0.9\nk3: -5.3\n"),
      AllOf(HasSubstr("folds the image"), HasSubstr("k1 = -1.9, k2 = 0.9, k3 = -5.3"), HasSubstr("px from cx, cy")));
  EXPECT_THAT(error_of(kWide + "k1: -20\n"), HasSubstr("folds the image"));
  EXPECT_THAT(error_of(kWide + "model: fisheye\nk1: -20\n"), HasSubstr("folds the image"));
  const std::string far = "fx: 1200\nfy: 1200\ncx: 320\ncy: 240\nwidth: 640\nheight: 480\n";
  EXPECT_EQ(notes_of(far + "k1: -0.9\nk2: 0.9\nk3: -5.3\n"), "") << "where nobody looks";
}

TEST(CameraWhoseLensFolds, IsUsedAsFarAsItDoesNotAndThatIsTold) {
  const std::string told = notes_of(kWide + "k1: -0.33\n");
  EXPECT_THAT(told, AllOf(HasSubstr("camera.yaml: "), HasSubstr(" % of the image lies beyond "),
                          HasSubstr("px from cx, cy"), HasSubstr("is not used")));
  EXPECT_EQ(error_of(kWide + "k1: -0.33\n"), "");
}

}  // namespace
}  // namespace rumi
