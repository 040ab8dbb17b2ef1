// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/windows/cut_window.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "bus/wire/image_codec.h"
#include "camera_driver/source/image_source.h"
#include "tests/support/temporary_folder.h"

namespace rumi::tool {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class FakeSource : public camera_driver::ImageSource {
 public:
  explicit FakeSource(int frames) : frames_(frames) {
    camera_.width = 64;
    camera_.height = 48;
    camera_.fx = camera_.fy = 50;
    camera_.cx = 31.5;
    camera_.cy = 23.5;
  }
  std::optional<image_t> next() override {
    if (handed_out == frames_) return std::nullopt;
    return make_grey_image(utime(handed_out++), cv::Mat(48, 64, CV_8UC1, cv::Scalar(90)));
  }
  const Camera& camera() const override { return camera_; }
  const std::string& name() const override { return name_; }
  int64_t total() const override { return frames_; }
  const camera_driver::SkippedFrames& skipped() const override { return skipped_; }

  static int64_t utime(int64_t frame) { return 1'000'000 + 100'000 * frame; }
  int handed_out = 0;

 private:
  int frames_;
  Camera camera_;
  std::string name_ = "the recording";
  camera_driver::SkippedFrames skipped_;
};

std::vector<int64_t> frames_of(const std::vector<ruminator::Sample>& samples) {
  std::vector<int64_t> frames;
  for (const ruminator::Sample& sample : samples) frames.push_back((sample.utime_us - FakeSource::utime(0)) / 100'000);
  return frames;
}

TEST(FrameRange, IsRead) {
  EXPECT_EQ(parse_frame_range("7..19").value().to_string(), "7..19");
  const FrameRange range = parse_frame_range("0..40:5").value();
  EXPECT_EQ(range.to_string(), "0..40:5");
  EXPECT_TRUE(range.contains(0));
  EXPECT_TRUE(range.contains(40));
  EXPECT_FALSE(range.contains(39));
  EXPECT_FALSE(range.contains(45));
  EXPECT_TRUE(parse_frame_range("3..3").has_value()) << "one frame";
}

TEST(FrameRange, WhatIsNoneIsRefused) {
  for (const char* text :
       {"", "7", "7..", "..9", "7.9", "7..9:", "7..9:x", "7..9 ", " 7..9", "-7..9", "7..-9", "7..9:-1", "7..9:5:5",
        "a..b", "1e3..2e3", "0..99999999999999999999", "0..9999999999999", "nan..9"})
    EXPECT_THAT(parse_frame_range(text).error_text(), HasSubstr("must be FIRST..LAST")) << text;
  EXPECT_THAT(parse_frame_range("9..7").error_text(), HasSubstr("ends before it begins"));
  EXPECT_THAT(parse_frame_range("7..9:0").error_text(), HasSubstr("stride"));
}

TEST(CutWindow, HasTheFramesAskedFor) {
  FakeSource source(100);
  const Result<ruminator::WindowJob> cut = cut_window(source, {FrameRange{2, 12, 5}, {14, 17}, FrameRange{20, 23, 2}});
  ASSERT_EQ(cut.error_text(), "");
  const ruminator::RuminationWindow& w = cut->window;
  EXPECT_THAT(frames_of(w.approach), ElementsAre(2, 7, 12));
  EXPECT_THAT(frames_of(w.gap), ElementsAre(14, 15, 16, 17));
  EXPECT_THAT(frames_of(w.departure), ElementsAre(20, 22));
  EXPECT_EQ(w.lost_utime_us, FakeSource::utime(14));
  EXPECT_EQ(w.resumed_utime_us, FakeSource::utime(20));
  EXPECT_EQ(cut->images.size(), 9u);
  EXPECT_EQ(source.handed_out, 24) << "the rest of the recording is not read";
}

TEST(CutWindow, CountsTheFramesThatTheStrideOfTheGapLeavesOut) {
  FakeSource source(100);
  const Result<ruminator::WindowJob> cut = cut_window(source, {{}, {10, 30, 10}, {}});
  ASSERT_EQ(cut.error_text(), "");
  EXPECT_THAT(frames_of(cut->window.gap), ElementsAre(10, 20, 30));
  EXPECT_EQ(cut->window.gap_frames, 21);
  EXPECT_THAT(cut->window.approach, IsEmpty());
  EXPECT_EQ(cut->window.resumed_utime_us, 0) << "nothing follows";
}

TEST(CutWindow, IsAJobThatCanBeWrittenAndRead) {
  FakeSource source(100);
  const Result<ruminator::WindowJob> cut = cut_window(source, {FrameRange{0, 5}, {6, 9}, FrameRange{10, 15}});
  const testing::TemporaryFolder folder;
  ASSERT_EQ(ruminator::write_window_job(folder / "cut.window", *cut).error_text(), "");
  const Result<ruminator::WindowJobFile> read = ruminator::read_window_job(folder / "cut.window");
  ASSERT_TRUE(read) << read.error_text();
  EXPECT_EQ(frames_of(read->job.window.gap), frames_of(cut->window.gap));
  EXPECT_EQ(read->job.images.size(), 16u);
}

TEST(CutWindow, PartsThatOverlapAreRefusedBeforeAnythingIsRead) {
  FakeSource source(100);
  EXPECT_THAT(cut_window(source, {FrameRange{0, 10}, {10, 20}, {}}).error_text(),
              HasSubstr("after the approach 0..10"));
  EXPECT_THAT(cut_window(source, {{}, {10, 20}, FrameRange{20, 30}}).error_text(), HasSubstr("after the gap 10..20"));
  EXPECT_EQ(source.handed_out, 0);
}

TEST(CutWindow, ARecordingThatIsTooShortIsNamed) {
  FakeSource source(15), empty(0);
  EXPECT_EQ(cut_window(source, {{}, {10, 20}, {}}).error_text(),
            "the recording: has 15 frames, the window ends with frame 20");
  EXPECT_THAT(cut_window(empty, {{}, {0, 0}, {}}).error_text(), HasSubstr("has 0 frames"));
}

}  // namespace
}  // namespace rumi::tool
