// SPDX-License-Identifier: BSD-3-Clause
// Tests `rumi mask`: which parts of a recording it finds that never move, and what is done with the mask.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "bus/transport/bus.h"
#include "bus/transport/log_file.h"
#include "bus/wire/image_codec.h"
#include "bus/wire/image_masks.h"
#include "tests/rumi/commands/end_to_end.h"

namespace rumi::tool {
namespace {

using ::testing::HasSubstr;

constexpr int kWidth = 320, kHeight = 240, kCaption = 40;  // kCaption: rows at the lower edge

cv::Mat noise(int width, int height, uint64_t seed) {
  cv::Mat pixels(height, width, CV_8U);
  cv::RNG(seed).fill(pixels, cv::RNG::UNIFORM, 0, 255);
  cv::GaussianBlur(pixels, pixels, {}, 2);
  cv::normalize(pixels, pixels, 0, 255, cv::NORM_MINMAX);
  return pixels;
}

// Writes images of a world that moves by, with or without a caption below it.
void write_recording(const std::filesystem::path& folder, bool has_caption) {
  const cv::Mat world = noise(1200, kHeight, 1), caption = noise(kWidth, kCaption, 2);
  std::filesystem::create_directories(folder);
  for (int i = 0; i < 40; ++i) {
    cv::Mat image = world(cv::Rect(20 * i, 0, kWidth, kHeight)).clone();
    if (has_caption) caption.copyTo(image.rowRange(kHeight - kCaption, kHeight));
    cv::imwrite((folder / fmt::format("{}.250.png", 1000 + i)).string(), image);
  }
  testing::write_file(folder / "calibration.yaml", "fx: 300\nfy: 300\ncx: 160\ncy: 120\nwidth: 320\nheight: 240\n");
}

Outcome rumi(const TemporaryFolder& work, const std::string& arguments) {
  return shell("cd '" + work.path().string() + "' && $RUMI/rumi " + arguments);
}

TEST(MaskCommand, FindsACaptionAndTheMaskGoesWithTheImages) {
  const TemporaryFolder work;
  write_recording(work.path() / "walk", true);
  const Outcome found = rumi(work, "mask walk -o walk/mask.png");
  EXPECT_EQ(found.exit_code, 0) << found.output;
  EXPECT_THAT(found.output, HasSubstr("% of the image never moves"));
  const cv::Mat mask = cv::imread(work / "walk/mask.png", cv::IMREAD_UNCHANGED);
  ASSERT_EQ(mask.size(), cv::Size(kWidth, kHeight));
  EXPECT_LT(cv::countNonZero(mask.rowRange(kHeight - kCaption + 8, kHeight)), kWidth * kCaption / 20);
  EXPECT_GT(cv::countNonZero(mask.rowRange(0, kHeight - kCaption - 16)), kWidth * 180 * 9 / 10);

  const Outcome exported = rumi(work, "export walk -o walk.lcm");
  EXPECT_EQ(exported.exit_code, 0) << exported.output;
  EXPECT_THAT(exported.output, HasSubstr("walk/mask.png"));
  LogReader log(work / "walk.lcm");
  int images = 0;
  while (const std::optional<LogEvent> event = log.next()) {
    image_t image;
    ASSERT_TRUE(Bus::decode(event->data, &image));
    EXPECT_EQ(cv::countNonZero(decode_mask(metadata(image, kMaskKey)).value() != mask), 0);
    ++images;
  }
  EXPECT_EQ(images, 40) << "mask.png is none of them";

  const Outcome imported = rumi(work, "import walk.lcm -o again");
  EXPECT_EQ(imported.exit_code, 0) << imported.output;
  const Outcome exported_again = rumi(work, "export again -o again.lcm");
  EXPECT_THAT(exported_again.output,
              HasSubstr("40 of 40 images have a mask of their own (the first: again/masks/rgb/"));
}

TEST(MaskCommand, IsWhiteWhereEverythingMovesAndOverwritesNothing) {
  const TemporaryFolder work;
  write_recording(work.path() / "walk", false);
  const Outcome found = rumi(work, "mask walk -o m.png");
  EXPECT_EQ(found.exit_code, 0) << found.output;
  EXPECT_THAT(found.output, HasSubstr("m.png is white"));
  const cv::Mat mask = cv::imread(work / "m.png", cv::IMREAD_UNCHANGED);
  EXPECT_EQ(cv::countNonZero(mask), kWidth * kHeight);
  EXPECT_EQ(rumi(work, "mask walk -o m.png").exit_code, 1);
}

}  // namespace
}  // namespace rumi::tool
