// SPDX-License-Identifier: BSD-3-Clause
#include "formats/video/video_times.h"

#include <gmock/gmock.h>

#include "bus/wire/image_codec.h"
#include "camera_driver/open_source.h"
#include "tests/formats/recording.h"
#include "tests/formats/write_video.h"

namespace rumi::camera_driver {
namespace {

using namespace testing;
using ::testing::HasSubstr;

// Returns the times of the images that camera_driver would publish. Checks that the pictures grow brighter with time,
// so that each one has its own time.
std::vector<int64_t> play(const fs::path& file, const CameraOptions& options = {}) {
  const OpenedSource opened = open_image_source(file.string(), options);
  EXPECT_EQ(opened.error_text(), "");
  std::vector<int64_t> times;
  double last = 0;
  while (const std::optional<image_t> image = opened.has_value() ? (*opened)->next() : std::nullopt) {
    times.push_back(image->utime);
    const double brightness = cv::mean(decode_grey(*image).value())[0];
    EXPECT_GT(brightness, last) << "frame " << times.size();
    last = brightness;
  }
  return times;
}

class VideoTimesTest : public ::testing::Test {
 protected:
  void write(const char* name, const VideoOptions& options) {
    if (!write_video(folder_ / name, options)) GTEST_SKIP() << "this FFmpeg cannot write such a video";
    testing::write_file(folder_ / "calibration.yaml", kCalibration);
  }
  TemporaryFolder folder_;
};

TEST_F(VideoTimesTest, AreThoseOfShowingWhateverTheOrderOfDecoding) {
  for (const int b_frames : {0, 1, 3}) {
    VideoOptions options;
    options.b_frames = b_frames;
    write("v.mp4", options);
    std::vector<int64_t> expected;
    for (int i = 0; i < options.frames; ++i) expected.push_back(i * options.step_us);
    EXPECT_EQ(play(folder_ / "v.mp4"), expected) << b_frames;
  }
}

// The first image behind the pause is decoded before those that are shown before the pause.
TEST_F(VideoTimesTest, RiseThroughAPauseWithImagesInAnotherOrderOfDecoding) {
  for (const char* name : {"v.mp4", "v.mkv", "v.ts"}) {
    for (const int before : {7, 8, 9, 10}) {
      VideoOptions options;
      options.container = name == std::string("v.mp4") ? "mp4" : name == std::string("v.mkv") ? "matroska" : "mpegts";
      options.b_frames = 3;
      options.pause_before = before;
      options.pause_steps = 500;
      write(name, options);
      std::vector<int64_t> expected;
      for (int i = 0; i < options.frames; ++i)
        expected.push_back((i + (i >= before ? options.pause_steps : 0)) * options.step_us);
      EXPECT_EQ(play(folder_ / name), expected) << name << " " << before;
    }
  }
}

TEST_F(VideoTimesTest, WithoutThemARateIsAskedFor) {
  VideoOptions options;
  options.container = "h264";
  write("v.h264", options);
  EXPECT_THAT(open_image_source(folder_ / "v.h264", {}).error_text(), HasSubstr("no times; give --rate HZ"));
  CameraOptions at_rate;
  at_rate.rate_hz = 10;
  const std::vector<int64_t> times = play(folder_ / "v.h264", at_rate);
  ASSERT_EQ(times.size(), 30u);
  EXPECT_EQ(times.back(), 2'900'000);
}

TEST_F(VideoTimesTest, OfBareImagesOneAfterTheOtherAreNone) {
  std::string jpegs;
  for (int i = 0; i < 30; ++i) {
    std::vector<uint8_t> jpeg;
    cv::imencode(".jpg", picture(i), jpeg);
    jpegs.append(jpeg.begin(), jpeg.end());
  }
  testing::write_file(folder_ / "v.mjpeg", jpegs);
  const VideoTimes times = read_video_times(folder_ / "v.mjpeg", 0);
  EXPECT_EQ(times.utimes.size(), 30u);
  EXPECT_FALSE(times.has_times);
}

TEST_F(VideoTimesTest, OfNoVideoAreNone) {
  testing::write_file(folder_ / "garbage.mp4", std::string(5000, 'g'));
  EXPECT_TRUE(read_video_times(folder_ / "garbage.mp4", 0).utimes.empty());
  EXPECT_TRUE(read_video_times(folder_ / "missing.mp4", 0).utimes.empty());
}

}  // namespace
}  // namespace rumi::camera_driver
