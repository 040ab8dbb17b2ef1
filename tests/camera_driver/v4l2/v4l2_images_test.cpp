// SPDX-License-Identifier: BSD-3-Clause
// Tests the images of a camera: their pixels and times, and which of them are left out.
#include <gmock/gmock.h>

#include "bus/wire/image_codec.h"
#include "bus/wire/image_masks.h"
#include "tests/camera_driver/v4l2/v4l2_source_fixture.h"

namespace rumi::camera_driver {
namespace {

using namespace testing;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST_F(V4l2SourceTest, ImagesComeWithTheirPixelsAndTimesOfCapture) {
  ASSERT_EQ(open(), "");
  fake_.add_frames(3, 100, grey_frame(1));
  const int64_t first_us = fake_.frames[0].stamp_us + fake_.offset_us();
  const std::vector<image_t> images = images_within(200'000);
  ASSERT_EQ(images.size(), 3u);
  EXPECT_EQ(images[0].data, grey_frame(1));
  EXPECT_EQ(images[0].pixelformat, image_t::PIXEL_FORMAT_GRAY);
  EXPECT_EQ(images[0].utime, first_us);
  EXPECT_EQ(images[2].utime, first_us + 66'666);
  EXPECT_EQ(metadata(images[0], kCalibrationKey), "");
  EXPECT_EQ(source_->skipped().total(), 0);
}

TEST_F(V4l2SourceTest, CarriesTheCalibrationAndTakesItsSize) {
  const TemporaryFolder folder;
  write_file(folder / "c.yaml", kCalibration);
  options_.camera_file = folder / "c.yaml";
  ASSERT_EQ(open(), "");
  fake_.add_frames(1, 0, grey_frame(1));
  const std::vector<image_t> images = images_within(50'000);
  ASSERT_EQ(images.size(), 1u);
  EXPECT_THAT(metadata(images[0], kCalibrationKey), HasSubstr("fx: 50"));
  source_.reset();
  options_.width = 32;
  EXPECT_THAT(open(), AllOf(HasSubstr("32 x 48"), HasSubstr("64 x 48")));
}

TEST_F(V4l2SourceTest, CarriesTheMaskThatIsGivenOrThatTheCalibrationNames) {
  const TemporaryFolder folder;
  const cv::Mat pixels = picture(1, kWidth, kHeight) > 99;
  write_file(folder / "m.png", encode_mask(pixels));
  write_file(folder / "c.yaml", std::string(kCalibration) + "mask: m.png\n");
  const auto mask_of_an_image = [this] {
    EXPECT_EQ(open(), "");
    fake_.add_frames(1, 0, grey_frame(1));
    const std::vector<image_t> images = images_within(50'000);
    source_.reset();
    return std::string(images.empty() ? "no image" : metadata(images[0], kMaskKey));
  };
  EXPECT_EQ(mask_of_an_image(), "");
  options_.mask = folder / "m.png";
  EXPECT_EQ(mask_of_an_image(), encode_mask(pixels)) << "without a calibration, too";
  options_.mask.clear();
  options_.camera_file = folder / "c.yaml";
  EXPECT_EQ(mask_of_an_image(), encode_mask(pixels));
  options_.mask = "none";
  EXPECT_EQ(mask_of_an_image(), "");
  options_.mask = folder.path().string();
  EXPECT_THAT(open(), HasSubstr("is not a file; give a PNG"));
  write_file(folder / "small.png", encode_mask(picture(1, 32, 48)));
  options_.mask = folder / "small.png";
  EXPECT_THAT(open(), AllOf(HasSubstr("32 x 48"), HasSubstr("64 x 48")));
}

TEST_F(V4l2SourceTest, GapsInTheNumberingAreCountedAcrossItsWrapAround) {
  ASSERT_EQ(open(), "");
  for (const uint32_t sequence : {0xFFFFFFF0u, 0xFFFFFFF4u, 2u, 3u, 0u, 1u})
    fake_.add_frames(1, sequence, grey_frame(1));
  for (size_t i = 0; i < fake_.frames.size(); ++i) fake_.frames[i].stamp_us += static_cast<int64_t>(i) * 1000;
  for (FakeFrame& frame : fake_.frames) frame.arrives_us = 0;
  fake_.advance(1'000'000);
  EXPECT_EQ(images_within(100'000).size(), 6u);
  EXPECT_EQ(source_->skipped().lost, 3 + 13);  // a numbering that begins again at 0 is no gap
  EXPECT_THAT(source_->skipped().to_string(), HasSubstr("16 lost by the camera or its driver"));
}

TEST_F(V4l2SourceTest, TimeGoingBackwardsOrStandingStillIsLeftOutAndCounted) {
  ASSERT_EQ(open(), "");
  const int64_t t = fake_.clocks.monotonic_us;
  for (const int64_t stamp : {t, t + 100, t + 100, t + 50, t + 200}) {
    fake_.add_frames(1, static_cast<uint32_t>(fake_.frames.size()), grey_frame(1));
    fake_.frames.back().stamp_us = stamp;
  }
  const std::vector<image_t> images = images_within(200'000);
  ASSERT_EQ(images.size(), 3u);
  for (size_t i = 1; i < images.size(); ++i) EXPECT_LT(images[i - 1].utime, images[i].utime);
  EXPECT_EQ(source_->skipped().duplicate, 1);
  EXPECT_EQ(source_->skipped().out_of_order, 1);
}

TEST_F(V4l2SourceTest, StampsOfAnotherClockAreReplacedByTheTimeOfArrival) {
  ASSERT_EQ(open(), "");
  fake_.add_frames(3, 0, grey_frame(1));
  fake_.frames[0].flags = V4L2_BUF_FLAG_TIMESTAMP_COPY;
  fake_.frames[1].stamp_us += 3'600'000'000;  // from the future
  fake_.frames[2].stamp_us = 0;               // hours ago
  std::vector<int64_t> arrivals;
  for (const FakeFrame& frame : fake_.frames) arrivals.push_back(frame.arrives_us + fake_.offset_us());
  std::vector<int64_t> utimes;
  for (const image_t& image : images_within(200'000)) utimes.push_back(image.utime);
  EXPECT_EQ(utimes, arrivals);
}

TEST_F(V4l2SourceTest, StampsOfAClockThatIsNotNamedAreBelievedWhereTheyCanBeRight) {
  ASSERT_EQ(open(), "");
  fake_.add_frames(2, 0, grey_frame(1));
  for (FakeFrame& frame : fake_.frames) {
    frame.flags = V4L2_BUF_FLAG_TIMESTAMP_UNKNOWN;
    frame.arrives_us += 20'000;
  }
  fake_.frames[1].stamp_us = fake_.clocks.system_us;
  const std::vector<int64_t> expected = {fake_.frames[0].stamp_us + fake_.offset_us(),
                                         fake_.frames[1].arrives_us + fake_.offset_us()};
  std::vector<int64_t> utimes;
  for (const image_t& image : images_within(200'000)) utimes.push_back(image.utime);
  EXPECT_EQ(utimes, expected);
}

TEST_F(V4l2SourceTest, ShortDamagedAndCorruptImagesAreLeftOutAndCounted) {
  fake_.formats = {{V4L2_PIX_FMT_MJPEG, {{64, 48}}, 30}};
  ASSERT_EQ(open(), "");
  const std::vector<uint8_t> good = jpeg_frame();
  std::vector<uint8_t> cut = good;
  cut.resize(good.size() / 2);
  for (const auto& data : {good, cut, {}, jpeg_frame(32, 32), grey_frame(3), good, good}) {
    fake_.add_frames(1, static_cast<uint32_t>(fake_.frames.size()), data);
    fake_.frames.back().stamp_us += static_cast<int64_t>(fake_.frames.size());
  }
  fake_.frames[5].flags |= V4L2_BUF_FLAG_ERROR;
  const std::vector<image_t> images = images_within(200'000);
  ASSERT_EQ(images.size(), 2u);
  EXPECT_EQ(images[0].data, good);  // the same bytes: the JPEG is not decoded
  EXPECT_EQ(images[0].pixelformat, image_t::PIXEL_FORMAT_MJPEG);
  EXPECT_EQ(source_->skipped().unreadable, 5);
}

TEST_F(V4l2SourceTest, RawImagesThatAreTooShortAreLeftOut) {
  ASSERT_EQ(open(), "");
  fake_.add_frames(1, 0, std::vector<uint8_t>(kWidth * kHeight - 1));
  EXPECT_THAT(images_within(100'000), IsEmpty());
  EXPECT_EQ(source_->skipped().unreadable, 1);
}

// bytesused may claim more bytes than the buffer has.
TEST_F(V4l2SourceTest, MoreBytesThanTheBufferHasAreNotRead) {
  fake_.buffer_bytes = 1000;
  ASSERT_EQ(open(), "");
  fake_.add_frames(1, 0, grey_frame(1));
  EXPECT_THAT(images_within(100'000), IsEmpty());
  EXPECT_EQ(source_->skipped().unreadable, 1);
}

TEST_F(V4l2SourceTest, TheRateIsMeasured) {
  ASSERT_EQ(open(), "");
  fake_.add_frames(100, 0, grey_frame(1));
  images_within(4'000'000);
  EXPECT_NEAR(source_->live()->rate_hz, 30, 0.01);
}

}  // namespace
}  // namespace rumi::camera_driver
