// SPDX-License-Identifier: BSD-3-Clause
#include "formats/video/video_choice.h"

#include <gmock/gmock.h>

#include "camera_driver/open_source.h"
#include "tests/formats/recording.h"
#include "tests/formats/write_video.h"

namespace rumi::camera_driver {
namespace {

using namespace testing;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class VideoChoiceTest : public ::testing::Test {
 protected:
  void write(const std::string& name, const VideoOptions& options) {
    if (!write_video(folder_ / name, options)) GTEST_SKIP() << "this FFmpeg cannot write such a video";
  }
  void join(const std::string& first, const std::string& second) {
    ASSERT_TRUE(join_videos({folder_ / first, folder_ / second}, folder_ / "both.mp4"));
  }
  std::vector<std::string> notes_of(const std::string& name) {
    const OpenedReader opened = open_frames(folder_ / name, {});
    EXPECT_EQ(opened.error_text(), "");
    return opened ? (*opened)->notes() : std::vector<std::string>();
  }
  // Returns the width of the images that are played; 0 if none are.
  int width_of(const std::string& name) {
    const OpenedSource opened = open_image_source(folder_ / name, {});
    EXPECT_EQ(opened.error_text(), "");
    int images = 0, width = 0;
    while (const std::optional<image_t> image = opened.has_value() ? (*opened)->next() : std::nullopt) {
      ++images;
      width = image->width;
    }
    EXPECT_EQ(images, 30);
    return width;
  }
  TemporaryFolder folder_;
};

TEST_F(VideoChoiceTest, IsTheStreamOfTheCalibrationsSizeElseTheLargest) {
  VideoOptions small, large;
  large.width = 128, large.height = 96;
  write("small.mp4", small);
  write("large.mp4", large);
  const std::string calibration = "fx: 50\nfy: 51\ncx: 32\ncy: 24\n";
  for (const auto& [first, second] : {std::pair{"small.mp4", "large.mp4"}, {"large.mp4", "small.mp4"}}) {
    join(first, second);
    folder_.write("calibration.yaml", calibration + "width: 64\nheight: 48\n");
    EXPECT_EQ(width_of("both.mp4"), 64);
    EXPECT_THAT(notes_of("both.mp4"), Contains(HasSubstr("which is of the calibration's size")));
    folder_.write("calibration.yaml", calibration + "width: 128\nheight: 96\n");
    EXPECT_EQ(width_of("both.mp4"), 128);
    fs::remove(folder_ / "calibration.yaml");
    const int larger = std::string(first) == "large.mp4" ? 0 : 1;
    EXPECT_EQ(choose_video_stream(folder_ / "both.mp4", {}).stream, larger);
    EXPECT_THAT(notes_of("both.mp4"),
                Contains(AllOf(HasSubstr("64 x 48"), HasSubstr("128 x 96"),
                               HasSubstr(fmt::format("stream {} is played, because none is larger", larger)))));
  }
}

TEST_F(VideoChoiceTest, OfTwoStreamsOfOneSizeIsOneOfThem) {
  write("small.mp4", {});
  join("small.mp4", "small.mp4");
  folder_.write("calibration.yaml", kCalibration);
  EXPECT_EQ(width_of("both.mp4"), 64);
}

TEST_F(VideoChoiceTest, SaysThatImagesAreInterlaced) {
  for (const AVCodecID codec : {AV_CODEC_ID_MPEG2VIDEO, AV_CODEC_ID_H264, AV_CODEC_ID_MPEG4}) {
    VideoOptions options;
    options.codec = codec;
    options.container = "matroska";
    write("progressive.mkv", options);
    EXPECT_THAT(notes_of("progressive.mkv"), IsEmpty()) << avcodec_get_name(codec);
    options.is_interlaced = true;
    write("interlaced.mkv", options);
    EXPECT_THAT(notes_of("interlaced.mkv"), Contains(AllOf(HasSubstr("is interlaced"), HasSubstr("bwdif"))))
        << avcodec_get_name(codec);
  }
}

TEST_F(VideoChoiceTest, SaysThatPixelsAreNotSquare) {
  VideoOptions options;
  options.pixel_shape = {1, 1};
  write("square.mp4", options);
  EXPECT_THAT(notes_of("square.mp4"), IsEmpty());
  options.pixel_shape = {4, 3};
  write("wide.mp4", options);
  EXPECT_THAT(notes_of("wide.mp4"),
              Contains(AllOf(HasSubstr("not square (4:3)"), HasSubstr("fx 0.75 times fy"), HasSubstr("setsar=1"))));
}

TEST_F(VideoChoiceTest, OfWhatIsNoVideoIsNone) {
  EXPECT_EQ(choose_video_stream(folder_.write("garbage.mp4", std::string(5000, 'g')), {}).stream, -1);
  EXPECT_EQ(choose_video_stream(folder_ / "missing.mp4", {}).stream, -1);
}

}  // namespace
}  // namespace rumi::camera_driver
