// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include "bus/wire/image_codec.h"
#include "camera_driver/open_source.h"
#include "formats/video/video_decoder.h"
#include "tests/formats/recording.h"
#include "tests/formats/write_video.h"

namespace rumi::camera_driver {
namespace {

using namespace testing;
using ::testing::Contains;
using ::testing::HasSubstr;

class VideoFramesTest : public ::testing::Test {
 protected:
  void write(const fs::path& file, const VideoOptions& options) {
    if (!write_video(file, options)) GTEST_SKIP() << "this FFmpeg cannot write such a video";
    testing::write_file(folder_ / "calibration.yaml", kCalibration);
  }
  // Returns the grey value in the middle of each image that is published.
  std::vector<int> play(const fs::path& file, const CameraOptions& options = {}) {
    OpenedSource opened = open_image_source(file.string(), options);
    EXPECT_EQ(opened.error_text(), "");
    std::vector<int> values;
    while (const std::optional<image_t> image = opened.has_value() ? (*opened)->next() : std::nullopt) {
      values.push_back(decode_grey(*image).value().at<uint8_t>(24, 32));
    }
    if (opened.has_value()) skipped_ = (*opened)->skipped();
    return values;
  }
  TemporaryFolder folder_;
  SkippedFrames skipped_;
};

// In the video, brightness goes from 16 to 235.
TEST_F(VideoFramesTest, AreOfTheWholeRangeOfGrey) {
  VideoOptions options;
  write(folder_ / "v.mp4", options);
  const std::vector<int> values = play(folder_ / "v.mp4");
  ASSERT_EQ(values.size(), 30u);
  for (int i = 0; i < 30; ++i) EXPECT_NEAR(values[i], (40 + 5 * i - 16) * 255.0 / 219, 2) << i;
}

// The codec FFV1 keeps each value.
TEST_F(VideoFramesTest, Of16BitsHaveOneRange) {
  VideoOptions options;
  options.container = "matroska";
  options.codec = AV_CODEC_ID_FFV1;
  options.pixels = AV_PIX_FMT_GRAY16LE;
  write(folder_ / "thermal.mkv", options);
  std::vector<int> values = play(folder_ / "thermal.mkv");
  ASSERT_EQ(values.size(), 30u);
  for (int i = 0; i < 30; ++i) EXPECT_NEAR(values[i], 255.0 * i / 29, 1) << i;  // the pixels have 1000 to 3900

  CameraOptions of_the_user;
  of_the_user.grey_range = "0:10200";
  values = play(folder_ / "thermal.mkv", of_the_user);
  ASSERT_EQ(values.size(), 30u);
  for (int i = 0; i < 30; ++i) EXPECT_NEAR(values[i], (1000 + 100 * i) / 40.0, 1) << i;
}

TEST_F(VideoFramesTest, OfAnotherSizeAreLeftOut) {
  VideoOptions options;
  options.container = "h264";
  write(folder_ / "a.h264", options);
  options.width = 128, options.height = 96;
  write(folder_ / "b.h264", options);
  testing::write_file(folder_ / "both.h264", read_file(folder_ / "a.h264") + read_file(folder_ / "b.h264"));
  CameraOptions at_rate;
  at_rate.rate_hz = 10;
  EXPECT_EQ(play(folder_ / "both.h264", at_rate).size(), 30u);
  EXPECT_EQ(skipped_.wrong_size, 30);
}

// Packets have no times of showing (AVI), or only some have one (MPEG's program streams).
TEST_F(VideoFramesTest, AreShownInTheirOrderWhateverIsStored) {
  for (const auto& [container, codec] : {std::pair{"avi", AV_CODEC_ID_H264},
                                         {"avi", AV_CODEC_ID_MPEG4},
                                         {"mpeg", AV_CODEC_ID_MPEG2VIDEO},
                                         {"mpegts", AV_CODEC_ID_H264}}) {
    VideoOptions options;
    options.container = container;
    options.codec = codec;
    options.b_frames = 2;
    const fs::path file = folder_ / fmt::format("v{}.{}", static_cast<int>(codec), container);
    write(file, options);
    const std::vector<int> values = play(file);
    EXPECT_EQ(values.size(), 30u) << file;
    EXPECT_TRUE(std::is_sorted(values.begin(), values.end())) << file;
    std::vector<int64_t> expected;
    for (int i = 0; i < 30; ++i) expected.push_back(i * options.step_us);
    EXPECT_EQ(open_frames(file.string(), {}).value()->utimes(), expected) << file;
  }
}

// A frame that cannot be decoded does not change the times of the others.
TEST_F(VideoFramesTest, KeepTheirTimesBehindDamage) {
  VideoOptions options;
  options.codec = AV_CODEC_ID_MJPEG;
  options.pixels = AV_PIX_FMT_YUVJ420P;
  options.container = "mov";
  write(folder_ / "v.mov", options);
  std::string bytes = read_file(folder_ / "v.mov");
  size_t at = 0;
  for (int i = 0; i <= 3; ++i) at = bytes.find("\xFF\xD8\xFF", at + 1);  // beginning of the fourth JPEG
  bytes.replace(at, 200, std::string(200, '\0'));
  testing::write_file(folder_ / "damaged.mov", bytes);
  const OpenedSource opened = open_image_source(folder_ / "damaged.mov", {});
  ASSERT_EQ(opened.error_text(), "");
  int images = 0;
  while (const std::optional<image_t> image = (*opened)->next()) {
    EXPECT_NEAR(decode_grey(*image).value().at<uint8_t>(24, 32), 40 + 5 * (image->utime / options.step_us), 3);
    ++images;
  }
  EXPECT_EQ(images, 29);
  EXPECT_EQ((*opened)->skipped().unreadable, 1);
}

// The decoder hides the damage by guessing.
TEST_F(VideoFramesTest, ThatFfmpegFindsDamagedAreLeftOut) {
  VideoOptions options;
  options.codec = AV_CODEC_ID_MPEG4;
  options.container = "matroska";
  options.width = 64, options.height = 48;
  write(folder_ / "v.mkv", options);
  std::string bytes = read_file(folder_ / "v.mkv");
  size_t at = 0;
  for (int i = 0; i < 8; ++i) at = bytes.find(std::string("\0\0\1\xB6", 4), at + 1);  // beginning of a picture
  ASSERT_NE(at, std::string::npos);
  for (size_t i = at + 6; i < at + 14; ++i) bytes[i] = static_cast<char>(~bytes[i]);
  testing::write_file(folder_ / "damaged.mkv", bytes);
  const size_t played = play(folder_ / "damaged.mkv").size();
  EXPECT_LT(played, 30u);
  EXPECT_EQ(skipped_.unreadable, 30 - static_cast<int64_t>(played));
  EXPECT_FALSE(skipped_.complaints(static_cast<int64_t>(played)).empty());
}

TEST_F(VideoFramesTest, OfACutOffFileAreCountedByItsLength) {
  VideoOptions options;
  options.container = "matroska";
  options.frames = 100;
  write(folder_ / "v.mkv", options);
  EXPECT_EQ(play(folder_ / "v.mkv").size(), 100u);
  EXPECT_EQ(skipped_.total(), 0);
  const std::string bytes = read_file(folder_ / "v.mkv");
  testing::write_file(folder_ / "cut.mkv", bytes.substr(0, bytes.size() / 2));
  const auto played = static_cast<int64_t>(play(folder_ / "cut.mkv").size());
  EXPECT_LT(played, 90);
  EXPECT_NEAR(static_cast<double>(skipped_.unreadable + played), 100, 3);
  EXPECT_FALSE(skipped_.complaints(played).empty());
  EXPECT_THAT(open_frames(folder_ / "cut.mkv", {}).value()->notes(),
              Contains(HasSubstr("images that its header promises")));

  CameraOptions beginning;
  beginning.duration_s = 0.4;
  play(folder_ / "cut.mkv", beginning);
  EXPECT_EQ(skipped_.unreadable, 0) << "what is asked for is there";
}

TEST_F(VideoFramesTest, CanBeHadInAnyOrder) {
  VideoOptions options;
  write(folder_ / "v.mp4", options);
  const OpenedReader opened = open_frames(folder_ / "v.mp4", {});
  ASSERT_TRUE(opened);
  for (const size_t frame : {20, 3, 29, 0, 0})
    EXPECT_NEAR((*opened)->load(frame, false)->data[24 * 64 + 32], (24 + 5.0 * frame) * 255 / 219, 2);
}

}  // namespace
}  // namespace rumi::camera_driver
