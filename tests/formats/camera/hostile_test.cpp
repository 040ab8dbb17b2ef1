// SPDX-License-Identifier: BSD-3-Clause
// Tests camera files that are wrong on purpose, or by a strange accident: they are refused at once, with a sentence.
#include <gmock/gmock.h>

#include <string>

#include "formats/camera/camera_file.h"
#include "tests/support/temporary_folder.h"

namespace rumi {
namespace {

using ::testing::HasSubstr;

class HostileCameraFile : public ::testing::Test {
 protected:
  std::string error_of(const std::string& text) { return read_camera_file(folder_.write("camera", text)).error_text(); }
  testing::TemporaryFolder folder_;
};

// Returns lists that each hold the list before 64 times, seven times over: 64^7 entries in two kilobytes.
std::string list_of_lists(const std::string& innermost) {
  std::string yaml = "a0: &a0 [" + innermost + "]\n";
  for (int level = 1; level < 8; ++level) {
    yaml += "a" + std::to_string(level) + ": &a" + std::to_string(level) + " [";
    for (int i = 0; i < 64; ++i) yaml += (i > 0 ? ", *a" : "*a") + std::to_string(level - 1);
    yaml += "]\n";
  }
  return yaml;
}

TEST_F(HostileCameraFile, ListsOfListsByAnchorsAreNotWalkedThrough) {
  EXPECT_THAT(error_of(list_of_lists("1")), HasSubstr("too many"));
  EXPECT_THAT(error_of(list_of_lists("") + "camera_matrix: *a7\nimage_width: 64\nimage_height: 48\n"),
              HasSubstr("too many"));
  EXPECT_THAT(error_of("fx: &x [*x, *x, *x]\n"), HasSubstr("too many"));
}

TEST_F(HostileCameraFile, AThousandCamerasAreNotEachReadInFull) {
  std::string groups, chain;
  for (int i = 0; i < 2000; ++i) {
    groups += "c" + std::to_string(i) + ": {camera_matrix: 1}\n";
    chain += "cam" + std::to_string(i) + ": {intrinsics: 1}\n";
  }
  EXPECT_THAT(error_of(groups), HasSubstr("has more than 64 cameras"));
  EXPECT_THAT(error_of(chain), HasSubstr("has more than 64 cameras"));
}

TEST_F(HostileCameraFile, ASizeThatIsNoIntIsRefused) {
  for (const char* size : {"1e300, 48", "64, -1e300", "64, 4294967344"})
    EXPECT_THAT(error_of("camera_matrix: [50, 0, 32, 0, 50, 24, 0, 0, 1]\ndist_coeffs: [0, 0, 0, 0]\nimage_size: [" +
                         std::string(size) + "]\n"),
                HasSubstr("whole numbers of pixels"));
  EXPECT_EQ(error_of("{\"cameraData\": [[1e300, {\"height\": 48, \"width\": 64, \"distortionCoeff\": [0, 0, 0, 0], "
                     "\"intrinsicMatrix\": [[50, 0, 32], [0, 50, 24], [0, 0, 1]]}]]}"),
            "");
}

TEST_F(HostileCameraFile, ALineOfAHundredThousandCommasIsRefused) {
  const std::string listing =
      "Intrinsic of \"Color\" / 64x48\n  Width: 64\n  Height: 48\n  PPX: 32\n  PPY: 24\n  Fx: 50\n  Fy: 50\n"
      "  Distortion: Brown Conrady\n  Coeffs: 0.1" +
      std::string(1 << 20, ',') + "0\n";
  EXPECT_THAT(error_of(listing), HasSubstr("Coeffs has 2 values"));
}

std::string repeated(const std::string& text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += text;
  return all;
}

TEST_F(HostileCameraFile, GroupsWithinGroupsDoNotOverflowTheStack) {
  EXPECT_NE(error_of("<?xml version=\"1.0\"?>\n<opencv_storage>\n" + repeated("<a>", 20'000)), "");
  EXPECT_NE(error_of("<?xml version=\"1.0\"?>\n<opencv_storage>\n" + repeated("<a>", 5'000) + repeated("</a>", 5'000) +
                     "</opencv_storage>\n"),
            "");
  for (const char* opening : {"[", "{", "{a: ", "- ", "? ", "!x ", "&a ", "- - ? "})
    EXPECT_NE(error_of("fx: 1\nx: " + repeated(opening, 15'000)), "") << opening;
}

TEST_F(HostileCameraFile, AListOfPosesOfADeepKindOrWithLongNamesIsRefused) {
  const std::string deep = repeated("[", 500'000) + repeated("]", 500'000);
  for (const std::string& text : {"{\"fl_x\": 1, \"frames\": " + deep + "}", "{\"frames\": [], \"fl_x\": " + deep + "}",
                                  "{\"frames\": [{\"fl_x\": " + deep + "}, {\"fl_x\": " + deep + "}]}",
                                  "{\"frames\": [], \"fl_x\": 1, \"" + std::string(3000, 'k') + "\": 1}"})
    EXPECT_THAT(error_of(text), HasSubstr("camera")) << text.substr(0, 40);
}

TEST_F(HostileCameraFile, AListingOfManyFieldsIsCutShort) {
  std::string listing = "Intrinsic of \"Color\" / 64x48\n";
  for (int i = 0; i < 200'000; ++i) listing += "k" + std::to_string(i) + ": " + std::to_string(i) + "\n";
  EXPECT_THAT(error_of(listing), HasSubstr("Width is missing"));
}

// YAML takes this byte for the end of the text.
TEST_F(HostileCameraFile, AnEndOfTransmissionIsRefused) {
  EXPECT_THAT(error_of("1 PINHOLE 64 48 5\x04 50 32 24\n"), HasSubstr("camera"));
  EXPECT_THAT(error_of("fx: 5\x04\n"), HasSubstr("not a text file"));
}

}  // namespace
}  // namespace rumi
