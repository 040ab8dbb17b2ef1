// SPDX-License-Identifier: BSD-3-Clause
// Tests the masks of a recording's images: where they come from, and which of them is used.
#include <gmock/gmock.h>

#include "bus/transport/bus.h"
#include "bus/transport/log_file.h"
#include "bus/wire/image_codec.h"
#include "bus/wire/image_masks.h"
#include "tests/camera_driver/opened_source.h"

namespace rumi::camera_driver {
namespace {

using namespace testing;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Returns a mask that leaves out the first `black` columns.
cv::Mat mask(int black, int width = 64, int height = 48) {
  cv::Mat pixels(height, width, CV_8U, cv::Scalar(255));
  pixels.colRange(0, black) = 0;
  return pixels;
}

void write_mask(const fs::path& file, const cv::Mat& pixels) {
  fs::create_directories(file.parent_path());
  ASSERT_TRUE(cv::imwrite(file.string(), pixels));
}

// Returns how many columns of each image are left out.
std::vector<int> black_columns(const fs::path& input, const CameraOptions& options = {}) {
  const OpenedSource opened = open_image_source(input.string(), options);
  EXPECT_EQ(opened.error_text(), "");
  std::vector<int> columns;
  while (const std::optional<image_t> image = opened.has_value() ? (*opened)->next() : std::nullopt) {
    const std::string png(metadata(*image, kMaskKey));
    const cv::Mat pixels = png.empty() ? mask(0) : decode_mask(png).value();
    EXPECT_EQ(pixels.size(), cv::Size(image->width, image->height));
    columns.push_back(cv::countNonZero(pixels.row(0) == 0));
  }
  return columns;
}

CameraOptions with_mask(const fs::path& file) {
  CameraOptions options;
  options.mask = file.string();
  return options;
}

class Masks : public ::testing::Test {
 protected:
  Masks() { write_tum(folder_.path(), 3); }
  const TemporaryFolder folder_;
};

TEST_F(Masks, ThereAreNoneUnlessThereAre) { EXPECT_THAT(black_columns(folder_.path()), ElementsAre(0, 0, 0)); }

TEST_F(Masks, OneFileIsOfAllImagesAlsoWhenTheyArePlayedAgain) {
  write_mask(folder_ / "m/any.png", mask(7));
  EXPECT_THAT(black_columns(folder_.path(), with_mask(folder_ / "m/any.png")), ElementsAre(7, 7, 7));
  const OpenedSource opened = open_image_source(folder_.path().string(), with_mask(folder_ / "m/any.png"));
  EXPECT_NE(metadata(*(*opened)->next(), kMaskKey), "");
  (*opened)->play_again({1000200000}, ImageSource::Pixels::kColour);
  EXPECT_NE(metadata(*(*opened)->next(), kMaskKey), "");
}

TEST_F(Masks, AFolderHasOneAnImageByTheNamesOfColmap) {
  for (const char* name : {"rgb/0.png.png", "rgb/0.png", "0.png.png", "0.png"}) {
    write_mask(folder_.path() / "given" / name, mask(9));
    EXPECT_THAT(black_columns(folder_.path(), with_mask(folder_ / "given")), ElementsAre(9, 0, 0)) << name;
    fs::remove_all(folder_ / "given");
  }
  write_mask(folder_ / "given/rgb/2.png.png", mask(0));
  write_mask(folder_ / "given/rgb/1.png.png", mask(64));  // a single image may be left out entirely
  EXPECT_THAT(black_columns(folder_.path(), with_mask(folder_ / "given")), ElementsAre(0, 64, 0));
}

TEST_F(Masks, JpegsHaveThemByBothNames) {
  write_tum(folder_ / "jpeg", 2, ".jpg");
  write_mask(folder_ / "given/rgb/0.jpg.png", mask(3));
  write_mask(folder_ / "given/rgb/1.png", mask(4));
  EXPECT_THAT(black_columns(folder_ / "jpeg", with_mask(folder_ / "given")), ElementsAre(3, 4));
}

TEST_F(Masks, AreFoundBesideTheRecording) {
  write_mask(folder_ / "mask.png", mask(5));
  EXPECT_THAT(black_columns(folder_.path()), ElementsAre(5, 5, 5));
  write_mask(folder_ / "masks/rgb/1.png.png", mask(8));
  EXPECT_THAT(black_columns(folder_.path()), ElementsAre(5, 8, 5)) << "both count: this one covers the other";
  write_mask(folder_ / "masks/rgb/1.png.png", mask(2));
  EXPECT_THAT(black_columns(folder_.path()), ElementsAre(5, 5, 5)) << "both count";
  write_mask(folder_ / "given.png", mask(1));
  EXPECT_THAT(black_columns(folder_.path(), with_mask(folder_ / "given.png")), ElementsAre(1, 1, 1));
  EXPECT_THAT(black_columns(folder_.path(), with_mask("none")), ElementsAre(0, 0, 0));
}

TEST_F(Masks, AFolderBesideTheRecordingMayBeOfSomethingElse) {
  write_mask(folder_ / "masks/person.png", mask(8));
  EXPECT_THAT(black_columns(folder_.path()), ElementsAre(0, 0, 0));
}

TEST_F(Masks, BesideImagesAreNoImages) {
  const fs::path images = folder_ / "images";
  for (const char* name : {"a1.jpg", "a2.jpg", "a3.png"}) write_mask(images / name, picture(1));
  write_file(images / "calibration.yaml", kCalibration);
  write_mask(images / "a1.jpg.png", mask(6));
  write_mask(images / "a3.png.png", mask(7));
  EXPECT_THAT(black_columns(images), ElementsAre(6, 0, 7));
  write_mask(images / "mask.png", mask(2));
  EXPECT_THAT(black_columns(images), ElementsAre(6, 2, 7));
}

TEST_F(Masks, OfACameraIsNamedByItsCalibrationAndLiesWhereThatSays) {
  write_mask(folder_ / "cameras/m.png", mask(4));
  write_file(folder_ / "cameras/c.yaml", std::string(kCalibration) + "mask: m.png\n");
  CameraOptions options;
  options.camera_file = folder_ / "cameras/c.yaml";
  EXPECT_THAT(black_columns(folder_.path(), options), ElementsAre(4, 4, 4));
  write_mask(folder_ / "mask.png", mask(5));
  EXPECT_THAT(black_columns(folder_.path(), options), ElementsAre(4, 4, 4)) << "before the one beside the data";
  fs::remove(folder_ / "cameras/m.png");
  EXPECT_THAT(error_of(folder_.path(), options), HasSubstr("cameras/m.png: no such file or folder"));
  for (const char* wrong : {"mask:\n", "mask: [a.png]\n"}) {
    write_file(folder_ / "cameras/c.yaml", kCalibration + std::string(wrong));
    EXPECT_THAT(error_of(folder_.path(), options), HasSubstr("must be the name of a PNG file")) << wrong;
  }
}

TEST_F(Masks, OneThatDoesNotFitIsRefusedAtTheStart) {
  write_mask(folder_ / "small.png", mask(5, 32, 24));
  const auto sizes = AllOf(HasSubstr("the mask is 32 x 24"), HasSubstr("the images are 64 x 48"), HasSubstr("make it"));
  EXPECT_THAT(error_of(folder_.path(), with_mask(folder_ / "small.png")), AllOf(HasSubstr("small.png: "), sizes));
  write_mask(folder_ / "given/2.png", mask(5, 32, 24));
  EXPECT_THAT(error_of(folder_.path(), with_mask(folder_ / "given")), AllOf(HasSubstr("given/2.png: "), sizes));
  write_mask(folder_ / "mask.png", mask(5, 32, 24));
  EXPECT_THAT(error_of(folder_.path()), AllOf(HasSubstr("mask.png: "), sizes));
}

TEST_F(Masks, OneThatIsMissingOrBrokenIsRefused) {
  EXPECT_THAT(error_of(folder_.path(), with_mask(folder_ / "no.png")), HasSubstr("no.png: no such file or folder"));
  EXPECT_THAT(error_of(folder_.path(), with_mask(folder_ / "rgb.txt")), HasSubstr("rgb.txt: is not a PNG"));
  write_mask(folder_ / "black.png", mask(64));
  EXPECT_THAT(error_of(folder_.path(), with_mask(folder_ / "black.png")), HasSubstr("black all over"));
  fs::create_directory(folder_ / "empty");
  EXPECT_THAT(error_of(folder_.path(), with_mask(folder_ / "empty")),
              AllOf(HasSubstr("empty: has no mask of any image: looked for"), HasSubstr("empty/rgb/0.png.png or ")));
}

TEST_F(Masks, OneThatTurnsOutBrokenLeavesItsImageAsItIs) {
  write_mask(folder_ / "given/0.png", mask(5));
  write_file(folder_ / "given/1.png", encode_mask(mask(5)).substr(0, 45));
  EXPECT_THAT(black_columns(folder_.path(), with_mask(folder_ / "given")), ElementsAre(5, 0, 0));
}

void write_log(const fs::path& file, bool has_mask) {
  fs::create_directories(file.parent_path());
  LogWriter log(file.string());
  for (int i = 0; i < 2; ++i) {
    image_t image = make_grey_image(1'000'000 * (i + 1), picture(i));
    if (has_mask) set_metadata(&image, kMaskKey, encode_mask(mask(3)));
    log.write(image.utime, channels::kCamera, encode_message(image));
  }
  ASSERT_TRUE(log.close());
}

TEST_F(Masks, ALogKeepsThoseOfItsImagesUnlessOneIsGiven) {
  write_log(folder_ / "l/with.lcm", true);
  write_log(folder_ / "l/without.lcm", false);
  write_mask(folder_ / "l/mask.png", mask(5));
  CameraOptions options;
  options.camera_file = folder_ / "calibration.yaml";
  EXPECT_THAT(black_columns(folder_ / "l/without.lcm", options), ElementsAre(0, 0)) << "beside it lie others' files";
  fs::copy(folder_ / "calibration.yaml", folder_ / "l/calibration.yaml");
  EXPECT_THAT(black_columns(folder_ / "l/with.lcm"), ElementsAre(3, 3));
  EXPECT_THAT(black_columns(folder_ / "l/without.lcm"), ElementsAre(5, 5));
  write_mask(folder_ / "given/0.png", mask(9));
  EXPECT_THAT(black_columns(folder_ / "l/with.lcm", with_mask(folder_ / "given/0.png")), ElementsAre(9, 9));
  EXPECT_THAT(black_columns(folder_ / "l/with.lcm", with_mask("none")), ElementsAre(0, 0));
  EXPECT_THAT(error_of(folder_ / "l/with.lcm", with_mask(folder_ / "given")), HasSubstr("give one PNG"));
}

}  // namespace
}  // namespace rumi::camera_driver
