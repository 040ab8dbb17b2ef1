// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/outputs/masks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "bus/wire/image_masks.h"
#include "rumi/outputs/map_file.h"
#include "rumi/outputs/output_folder.h"
#include "tests/rumi/small_atlas.h"
#include "tests/support/temporary_folder.h"

namespace rumi::tool {
namespace {

namespace fs = std::filesystem;
using map_server::StillMask;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// Returns a mask for images of 64 x 48 pixels that leaves out the lowest `rows`.
StillMask make_mask(int64_t session, int rows) {
  cv::Mat pixels(48, 64, CV_8U, cv::Scalar(255));
  pixels.rowRange(48 - rows, 48) = 0;
  return {.session = session,
          .utime_us = 1'000'000,
          .width = 64,
          .height = 48,
          .left_out = rows / 48.0,
          .png = rows == 0 ? "" : encode_mask(pixels)};
}

class MasksOfARun : public ::testing::Test {
 protected:
  cv::Mat read(const std::string& name) const {
    return cv::imread((folder_.path() / name).string(), cv::IMREAD_GRAYSCALE);
  }
  bool exists(const std::string& name) const { return fs::exists(folder_.path() / name); }
  std::string folder() const { return folder_.path().string(); }

  const testing::TemporaryFolder folder_;
};

TEST_F(MasksOfARun, AreThoseOfItsSessionsThatLeaveSomethingOut) {
  map_server::Atlas atlas;
  atlas.record_mask(1, make_mask(7, 8));
  atlas.record_mask(2, make_mask(8, 8));
  atlas.record_mask(3, make_mask(8, 0));
  EXPECT_EQ(masks_of(atlas).size(), 2u);
  EXPECT_EQ(masks_of(atlas, 7), (RunMasks{{2, make_mask(8, 8)}}));
}

TEST_F(MasksOfARun, AreSaidInALineEach) {
  EXPECT_THAT(describe_masks({}), IsEmpty());
  EXPECT_THAT(describe_masks({{1, make_mask(7, 8)}}),
              ElementsAre("17 % of the image never moves (bonnet or caption): left out, mask.png shows it"));
  EXPECT_THAT(
      describe_masks({{1, make_mask(7, 8)}, {12, make_mask(7, 1)}}),
      ElementsAre("17 % of the image of stream 1 never moves (bonnet or caption): left out, mask-1.png shows it",
                  "2.1 % of the image of stream 12 never moves (bonnet or caption): left out, mask-12.png "
                  "shows it"));
}

TEST_F(MasksOfARun, AreInRunJson) {
  const nlohmann::ordered_json json = masks_to_json({{12, make_mask(7, 12)}});
  ASSERT_EQ(json.size(), 1u);
  EXPECT_EQ(json[0]["stream"], 12);
  EXPECT_EQ(json[0]["session"], 7);
  EXPECT_EQ(json[0]["left_out"], 0.25);
  EXPECT_EQ(json[0]["file"], "mask.png");
  EXPECT_EQ(masks_to_json({}).dump(), "[]");
}

TEST_F(MasksOfARun, AreWrittenAsLargeAsTheImages) {
  EXPECT_THAT(write_masks({{5, make_mask(7, 12)}}, folder(), {128, 96}), IsEmpty());
  const cv::Mat mask = read("mask.png");
  ASSERT_EQ(mask.size(), cv::Size(128, 96));
  EXPECT_EQ(cv::countNonZero(mask.rowRange(0, 70)), 128 * 70);
  EXPECT_EQ(cv::countNonZero(mask.rowRange(72, 96)), 0);
  // Images of another shape are of another camera, so the mask is not scaled.
  EXPECT_THAT(write_masks({{5, make_mask(7, 12)}}, folder(), {128, 64}), IsEmpty());
  EXPECT_EQ(read("mask.png").size(), cv::Size(64, 48));
}

TEST_F(MasksOfARun, ReplaceThoseOfTheRunBeforeAndNothingElse) {
  for (const char* name : {"mask-of-mine.png", "mask-.png", "mask-1.jpg", "my-mask.png"})
    std::ofstream(folder_.path() / name) << "somebody's";
  EXPECT_THAT(write_masks({{1, make_mask(7, 8)}, {2, make_mask(7, 8)}}, folder()), IsEmpty());
  EXPECT_TRUE(exists("mask-1.png") && exists("mask-2.png") && !exists("mask.png"));
  EXPECT_THAT(write_masks({{1, make_mask(7, 8)}}, folder()), IsEmpty());
  EXPECT_TRUE(!exists("mask-1.png") && !exists("mask-2.png") && exists("mask.png"));
  EXPECT_THAT(write_masks({}, folder()), IsEmpty());
  EXPECT_FALSE(exists("mask.png"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), {}), 4);
}

TEST_F(MasksOfARun, AreAmongItsOutputs) {
  map_server::Atlas atlas = make_test_atlas();
  atlas.record_mask(1, make_mask(1, 8));
  EXPECT_THAT(write_run_outputs(atlas, folder()), IsEmpty());
  EXPECT_TRUE(exists("mask.png"));
  EXPECT_THAT(write_run_outputs(atlas, folder(), /*after=*/1), IsEmpty());
  EXPECT_FALSE(exists("mask.png"));
}

TEST_F(MasksOfARun, OfSomebodyAreNotOverwritten) {
  std::ofstream(folder_.path() / "mask.png") << "the only copy";
  EXPECT_THAT(check_output_folder(folder()).error_text(), HasSubstr("mask.png would be overwritten"));
}

TEST_F(MasksOfARun, DoNotReplaceTheOneThatIsUsed) {
  const std::string out = folder() + "/out", recording = folder() + "/recording";
  fs::create_directory(out);
  fs::create_directory(recording);
  for (const std::string& name : {out + "/mask.png", out + "/mine.png", recording + "/mask.png"})
    std::ofstream{name} << "edited";
  EXPECT_THAT(check_mask_stays(out + "/mask.png", recording, out).error_text(), HasSubstr("another name"));
  EXPECT_THAT(check_mask_stays(out + "/../out/mask.png", recording, out).error_text(), HasSubstr("another name"));
  EXPECT_EQ(check_mask_stays(out + "/mine.png", recording, out).error_text(), "");
  EXPECT_EQ(check_mask_stays("", recording, out).error_text(), "");
  EXPECT_EQ(check_mask_stays("none", recording, out).error_text(), "");
  EXPECT_EQ(check_mask_stays("", "", out).error_text(), "");
  EXPECT_THAT(check_mask_stays("", recording, recording).error_text(), HasSubstr("another folder"));
  std::ofstream(recording + "/rgb.txt") << "";
  EXPECT_THAT(check_mask_stays("", recording + "/rgb.txt", recording).error_text(), HasSubstr("another folder"));
}

}  // namespace
}  // namespace rumi::tool
