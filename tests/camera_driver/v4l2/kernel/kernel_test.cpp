// SPDX-License-Identifier: BSD-3-Clause
// Tests camera_driver with the kernel's own V4L2, in a virtual machine (tests/virtual_machine/run_in_qemu.sh): formats
// byte for byte, times against the camera's schedule, losses, errors, unplugging, and the whole process on LCM.
#include <gmock/gmock.h>
#include <time.h>

#include <cstdio>
#include <functional>
#include <opencv2/core.hpp>

#include "bus/process/process.h"
#include "bus/transport/lcm_bus.h"
#include "bus/wire/image_codec.h"
#include "camera_driver/v4l2/pixel_format.h"
#include "lcmtypes/rumi/process_status_t.hpp"
#include "tests/camera_driver/v4l2/kernel/burnt_in_text.h"
#include "tests/camera_driver/v4l2/kernel/kernel_camera.h"
#include "tests/camera_driver/v4l2/kernel/kernel_fixture.h"

namespace rumi::camera_driver {
namespace {

using namespace testing;
using ::testing::HasSubstr;

class KernelTest : public CameraSourceTest {
 protected:
  KernelTest() {
    options_.width = kWidth;
    options_.height = kHeight;
    options_.rate_hz = 15;
    options_.controls = "osd_text_mode=2, test_pattern=4";
  }
  void SetUp() override {
    if (!KernelCamera::is_there()) KernelCamera::plug_in();
    ASSERT_TRUE(KernelCamera::is_there());
    for (const char* name :
         {"percentage_of_dropped_buffers", "timestamp_source", "wrap_timestamp", "wrap_sequence_number"})
      KernelCamera::set(name, 0);
  }
  std::string open(const std::string& input = kDevice) { return CameraSourceTest::open(input); }
};

bool has_luma(const PixelFormat& format) {
  return format.layout != PixelLayout::kRgb && format.layout != PixelLayout::kBayer;
}

// Returns where in our image the byte at (x, y) of the format's first plane must be found again. Our image is grey if
// the format has luma, else RGB: there the bytes of RGB and Bayer formats are a channel of the same pixel. -1: nowhere
// (chroma).
int64_t place_in_image(const PixelFormat& format, int x, int y) {
  const int64_t pixels = int64_t{y} * kWidth;
  switch (format.layout) {
    case PixelLayout::kPackedYuv:
      return x % 2 == (format.option == "uyvy" ? 1 : 0) ? pixels + x / 2 : -1;
    case PixelLayout::kRgb:
      return 3 * pixels + (format.option == "bgr24" ? x / 3 * 3 + 2 - x % 3 : x);
    case PixelLayout::kBayer: {
      const bool at_border = x == 0 || y == 0 || x == kWidth - 1 || y == kHeight - 1;  // interpolated from the inside
      const char channel = format.option[static_cast<size_t>(y % 2 * 2 + x % 2)];
      return at_border ? -1 : 3 * (pixels + x) + (channel == 'r' ? 0 : channel == 'g' ? 1 : 2);
    }
    default:
      return pixels + x;
  }
}

void expect_same_bytes(const PixelFormat& format, const std::vector<uint8_t>& reference, const image_t& image) {
  const auto stride = static_cast<int>(row_bytes(format, kWidth));
  ASSERT_GE(static_cast<int64_t>(reference.size()), *frame_bytes(format, kWidth, kHeight, stride));
  int compared = 0, different = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < stride; ++x) {
      const int64_t place = place_in_image(format, x, y);
      if (place < 0) continue;
      ++compared;
      different += reference[static_cast<size_t>(y) * stride + x] != image.data[static_cast<size_t>(place)];
    }
  EXPECT_GE(compared, (kWidth - 2) * (kHeight - 2));
  EXPECT_EQ(different, 0);
}

// Returns the mean colour of the middle of an RGB image.
cv::Scalar middle(const image_t& image) {
  const cv::Mat rgb(kHeight, kWidth, CV_8UC3, const_cast<uint8_t*>(image.data.data()));
  return cv::mean(rgb(cv::Rect(kWidth / 4, kHeight / 4, kWidth / 2, kHeight / 2)));
}

TEST_F(KernelTest, EveryFormatIsTheSameToTheByteAsAnotherProgramGetsIt) {
  std::vector<uint32_t> offered;
  {
    const OpenedDevice opened = open_video_device(kernel_video_system(), kDevice);
    ASSERT_EQ(opened.error, "");
    offered = pixel_formats_of(*opened.device);
  }
  int tested = 0, frames = 0;
  for (const uint32_t fourcc : offered) {
    const PixelFormat* format = find_pixel_format(fourcc);
    if (!format) continue;
    SCOPED_TRACE(format->option);
    options_.format = format->option;
    options_.encoding = has_luma(*format) ? "grey" : "rgb";
    ASSERT_EQ(open(), "");
    const std::vector<image_t> images = take(10);
    ASSERT_EQ(images.size(), 10u);
    const int64_t lost = source_->skipped().total();
    source_.reset();
    for (const image_t& image : images) {
      ASSERT_EQ(check_image(image).error_text(), "");
      ASSERT_EQ(image.data, images[0].data);  // the picture stands still
    }
    expect_same_bytes(*format, KernelCamera::reference_frame(fourcc_text(fourcc)), images[0]);

    // Checks the colour conversion of each format with a known colour.
    options_.controls = "osd_text_mode=2, test_pattern=7";
    std::string colour = "has none";
    if (format->layout != PixelLayout::kGrey) {
      options_.encoding = "rgb";
      ASSERT_EQ(open(), "");
      const std::vector<image_t> red = take(1);
      source_.reset();
      ASSERT_EQ(red.size(), 1u);
      const cv::Scalar rgb = middle(red[0]);
      EXPECT_NEAR(rgb[0], 255, 3);
      EXPECT_NEAR(rgb[1], 0, 3);
      EXPECT_NEAR(rgb[2], 0, 3);
      colour = "red is " + std::to_string(std::lround(rgb[0])) + " " + std::to_string(std::lround(rgb[1])) + " " +
               std::to_string(std::lround(rgb[2]));
    }
    options_.controls = "osd_text_mode=2, test_pattern=4";
    std::printf("format %s: %zu frames, %ld left out, %s\n", format->option.c_str(), images.size(),
                static_cast<long>(lost), colour.c_str());
    ++tested;
    frames += static_cast<int>(images.size());
  }
  std::printf("%d formats of %zu offered, %d frames\n", tested, offered.size(), frames);
  EXPECT_GE(tested, 14);
}

// Learns the digits of vivid's text from a stream of its own, because an ImageSource does not tell the driver's number
// of a frame.
BurntInText learn_digits() {
  BurntInText text;
  OpenedDevice opened = open_video_device(kernel_video_system(), kDevice);
  OpenedStream stream = open_stream(std::move(opened.device), {kWidth, kHeight, 15, "grey"});
  EXPECT_EQ(stream.error + (stream.stream ? stream.stream->start() : ""), "");
  const int64_t end = monotonic_us() + 20 * kSecondUs;
  while (text.digits_known() < 10 && monotonic_us() < end) {
    StreamFrame frame;
    std::string error;
    if (stream.stream->read(100, &frame, &error) != VideoStream::Read::kFrame) continue;
    EXPECT_TRUE(frame.stamps.monotonic);
    text.learn(frame.image.data.data(), frame.image.stride, frame.sequence);
    EXPECT_EQ(stream.stream->release(), "");
  }
  EXPECT_EQ(text.digits_known(), 10u);
  return text;
}

// vivid draws its clock, which counts the kernel's ticks (4 ms), into the frame that it stamps.
TEST_F(KernelTest, TimesAreThoseOfTheCamerasOwnClock) {
  constexpr int64_t kTickUs = 4000;
  options_.controls = "osd_text_mode=0, test_pattern=5";
  KernelCamera::set("osd_text_mode", 0);
  KernelCamera::set("test_pattern", 5);
  const BurntInText text = learn_digits();
  for (const int start_of_exposure : {0, 1}) {
    KernelCamera::set("timestamp_source", start_of_exposure);
    ASSERT_EQ(open(), "");
    std::vector<int64_t> differences_us, latencies_us;
    for (const int64_t end = monotonic_us() + 20 * kSecondUs; differences_us.size() < 60 && monotonic_us() < end;) {
      const std::optional<image_t> image = source_->next();
      if (!image) continue;
      const std::optional<int64_t> clock_ms = text.clock_ms(image->data.data(), image->row_stride);
      ASSERT_TRUE(clock_ms);
      differences_us.push_back(image->utime - *clock_ms * 1000);
      latencies_us.push_back(kernel_video_system().now().system_us - image->utime);
    }
    ASSERT_EQ(differences_us.size(), 60u);
    std::sort(differences_us.begin(), differences_us.end());
    std::sort(latencies_us.begin(), latencies_us.end());
    const int64_t median_us = differences_us[30];  // system time at which the stream began
    std::vector<int64_t> errors_us;
    for (const int64_t difference : differences_us) errors_us.push_back(std::abs(difference - median_us));
    std::sort(errors_us.begin(), errors_us.end());
    // Tested for 90 % of the frames: the virtual machine itself may be stopped between the two clocks.
    EXPECT_LT(errors_us[54], 2 * kTickUs);
    // vivid draws at once, and says that the frame ends 9/10 of a period later.
    const double stamped_ahead = static_cast<double>(-latencies_us[30]) * options_.rate_hz * 1e-6;
    EXPECT_NEAR(stamped_ahead, start_of_exposure ? 0 : 0.9, 0.2);
    std::printf(
        "stamp at the %s: 60 frames, %ld lost, error against the camera's clock p50 %.1f ms, p90 %.1f ms, worst "
        "%.1f ms; from stamp to us p50 %.1f ms, worst %.1f ms\n",
        start_of_exposure ? "start of exposure" : "end of the frame", static_cast<long>(source_->skipped().lost),
        static_cast<double>(errors_us[30]) * 1e-3, static_cast<double>(errors_us[54]) * 1e-3,
        static_cast<double>(errors_us.back()) * 1e-3, static_cast<double>(latencies_us[30]) * 1e-3,
        static_cast<double>(latencies_us.back()) * 1e-3);
    source_.reset();
  }
}

TEST_F(KernelTest, ASystemClockThatIsSetLooksLikeNoMotion) {
  ASSERT_EQ(open(), "");
  ASSERT_EQ(take(5).size(), 5u);
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  const timespec earlier{now.tv_sec - 100, now.tv_nsec};
  ASSERT_EQ(clock_settime(CLOCK_REALTIME, &earlier), 0);
  const std::vector<image_t> images = take(10);
  clock_gettime(CLOCK_REALTIME, &now);
  const timespec again{now.tv_sec + 100, now.tv_nsec};
  clock_settime(CLOCK_REALTIME, &again);
  ASSERT_EQ(images.size(), 10u);
  for (size_t i = 1; i < images.size(); ++i) {
    EXPECT_GT(images[i].utime, images[i - 1].utime);
    EXPECT_LT(images[i].utime, images[i - 1].utime + kSecondUs);
  }
}

TEST_F(KernelTest, TimeStampsThatWrapAroundAreNotBelieved) {
  KernelCamera::set("wrap_timestamp", 1);
  ASSERT_EQ(open(), "");
  for (const image_t& image : take(5)) {
    EXPECT_LT(std::abs(kernel_video_system().now().system_us - image.utime), 5 * kSecondUs);
  }
}

TEST_F(KernelTest, WhatTheDriverDropsIsCounted) {
  KernelCamera::set("percentage_of_dropped_buffers", 30);
  ASSERT_EQ(open(), "");
  const double period_us = 1e6 / options_.rate_hz;
  const std::vector<image_t> images = take(40);
  ASSERT_EQ(images.size(), 40u);
  const auto span = static_cast<double>(images.back().utime - images.front().utime);
  const auto missing = std::lround(span / period_us) - 39;
  std::printf("30 %% dropped by the driver: %ld missing by the times, %ld counted\n", missing,
              static_cast<long>(source_->skipped().lost));
  EXPECT_GT(missing, 3);
  EXPECT_GE(source_->skipped().lost, missing);  // images dropped before the first one are counted, too
  EXPECT_LE(source_->skipped().lost, missing + 5);
}

TEST_F(KernelTest, ADamagedFrameIsLeftOut) {
  ASSERT_EQ(open(), "");
  ASSERT_EQ(take(3).size(), 3u);
  KernelCamera::press("inject_v4l2_buf_flag_error");
  EXPECT_TRUE(wait_for([&] { return source_->skipped().unreadable == 1; }));
  EXPECT_EQ(take(3).size(), 3u);
}

TEST_F(KernelTest, AStreamThatBreaksIsOpenedAgain) {
  ASSERT_EQ(open(), "");
  ASSERT_EQ(take(3).size(), 3u);
  KernelCamera::press("inject_fatal_streaming_error");
  EXPECT_TRUE(wait_for([&] { return !source_->live()->problem.empty(); }));
  std::printf("%s\n", source_->live()->problem.c_str());
  EXPECT_EQ(take(3).size(), 3u);
  EXPECT_EQ(source_->live()->problem, "");
  for (const char* error :
       {"inject_vidioc_reqbufs_error", "inject_vidioc_qbuf_error", "inject_vidioc_streamon_error"}) {
    source_.reset();
    KernelCamera::press(error);
    EXPECT_NE(open(), "") << error;  // it fails once, and says so
    EXPECT_EQ(open(), "") << error;
  }
}

TEST_F(KernelTest, UnpluggedAndPluggedInAgain) {
  ASSERT_EQ(open(), "");
  ASSERT_EQ(take(3).size(), 3u);
  for (const bool by_driver : {true, false}) {
    if (by_driver)
      KernelCamera::press("disconnect");
    else
      KernelCamera::unplug();
    EXPECT_TRUE(wait_for([&] { return !source_->live()->problem.empty(); }));
    std::printf("%s\n", source_->live()->problem.c_str());
    if (by_driver) KernelCamera::unplug();
    EXPECT_TRUE(take(1, kSecondUs).empty());
    const int64_t begin_us = monotonic_us();
    KernelCamera::plug_in();
    ASSERT_EQ(take(3).size(), 3u);
    std::printf("images again %.1f s after it was plugged in\n", static_cast<double>(monotonic_us() - begin_us) * 1e-6);
    EXPECT_EQ(source_->live()->problem, "");
  }
}

TEST_F(KernelTest, ABusyCameraIsWaitedFor) {
  OpenedSource other = open_camera(kernel_video_system(), kDevice, options_);
  ASSERT_EQ(other.error_text(), "");
  ASSERT_EQ(open(), "");
  EXPECT_THAT(source_->live()->problem, HasSubstr("in use by another program"));
  EXPECT_TRUE(take(1, kSecondUs).empty());
  other->reset();
  EXPECT_EQ(take(3).size(), 3u);
}

TEST_F(KernelTest, NamesAreLookedUp) {
  EXPECT_THAT(open("camera:vivid"), HasSubstr("/dev/video0, /dev/video1"));  // the machine has two such cameras
  EXPECT_THAT(open("camera:nonsense"), HasSubstr("no camera has this name"));
  EXPECT_THAT(open("/dev/video9"), HasSubstr("/dev/video0, /dev/video1"));
  options_.width = 321;
  EXPECT_THAT(open(), HasSubstr("320 x 180, 640 x 360"));
}

TEST_F(KernelTest, AutomaticGainIsLocked) {
  KernelCamera::set("gain_automatic", 1);
  options_.lock_auto_s = 0.5;
  ASSERT_EQ(open(), "");
  EXPECT_TRUE(wait_for([] { return KernelCamera::get("gain_automatic") == 0; }));
}

TEST_F(KernelTest, TheProcessOnLcm) {
  const auto write = [](const std::string& file, const std::string& text) { std::ofstream(file) << text; };
  write("/run/camera.yaml", "fx: 300\nfy: 300\ncx: 160\ncy: 90\nwidth: 320\nheight: 180\nfps: 15\n");
  write("/run/config.yaml", "camera_driver:\n  controls: \"brightness=100, osd_text_mode=2\"\n");
  const Result<std::unique_ptr<LcmBus>> opened = LcmBus::open(kDefaultLcmUrl, {});
  ASSERT_TRUE(opened) << opened.error_text();
  const std::unique_ptr<LcmBus>& bus = *opened;
  int64_t images = 0, last_us = 0, late = 0;
  process_status_t status{};
  bus->subscribe<image_t>(channels::kCamera, {}, [&](const image_t& image) {
    ++images;
    late += image.utime <= last_us;
    last_us = image.utime;
    EXPECT_EQ(check_image(image).error_text(), "");
    EXPECT_THAT(metadata(image, kCalibrationKey), HasSubstr("fx: 300"));
  });
  bus->subscribe<process_status_t>(channels::kStatus, {}, [&](const process_status_t& message) { status = message; });
  const auto until = [&bus](const std::function<bool()>& condition) { return hear_until(*bus, condition); };
  Process process({kDevice, "--camera", "/run/camera.yaml", "--config", "/run/config.yaml"});
  ASSERT_TRUE(until([&] { return images >= 30; }));
  EXPECT_EQ(KernelCamera::get("brightness"), 100);
  write("/run/config.yaml", "camera_driver:\n  controls: \"brightness=50\"\n");
  process.signal(SIGUSR2);
  EXPECT_TRUE(until([] { return KernelCamera::get("brightness") == 50; }));
  KernelCamera::unplug();
  EXPECT_TRUE(until([&] { return status.state == process_status_t::DEGRADED; }));
  EXPECT_THAT(status.detail, HasSubstr("no images now"));
  KernelCamera::plug_in();
  const int64_t before = images;
  EXPECT_TRUE(until([&] { return images > before + 15 && status.state == process_status_t::RUNNING; }));
  EXPECT_EQ(late, 0);
  EXPECT_EQ(KernelCamera::get("brightness"), 50);  // the driver has set it again
  std::printf("process: %ld images over LCM, status: %s\n", static_cast<long>(images), status.detail.c_str());
  EXPECT_EQ(process.end(SIGTERM), 0);
}

}  // namespace
}  // namespace rumi::camera_driver
