// SPDX-License-Identifier: BSD-3-Clause
// Tests camera_driver with v4l2loopback, a camera whose images are known because the test itself gives them: with
// MJPEG, which vivid does not have, and with images that fail to come. The images come one by one, so that nothing
// depends on speed.
#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <fstream>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <thread>

#include "bus/process/process.h"
#include "bus/transport/lcm_bus.h"
#include "bus/wire/image_codec.h"
#include "bus/wire/jpeg_image.h"
#include "lcmtypes/rumi/process_status_t.hpp"
#include "tests/camera_driver/v4l2/kernel/camera_feeder.h"
#include "tests/camera_driver/v4l2/kernel/kernel_fixture.h"

namespace rumi::camera_driver {
namespace {

using namespace testing;
using ::testing::HasSubstr;

constexpr int kWidth = 640, kHeight = 480;
constexpr uint32_t kRateHz = 15;

cv::Mat picture(int number) {
  cv::Mat image(kHeight, kWidth, CV_8UC3);
  cv::RNG random(static_cast<uint64_t>(number) + 1);
  random.fill(image, cv::RNG::UNIFORM, 0, 60);
  image(cv::Rect(8 * number % kWidth / 2, 40, kWidth / 4, kHeight / 2)) += cv::Scalar(30, 90, 150);
  return image;
}

// Returns JPEGs of different lengths, as a camera's are, with zeros behind the end, as many cameras give them.
std::vector<uint8_t> jpeg(int number) {
  std::vector<uint8_t> bytes = make_jpeg_image(0, picture(number), 40 + number % 50).data;
  bytes.resize(bytes.size() + static_cast<size_t>(number % 3));
  return bytes;
}

std::vector<uint8_t> yuyv(int number) {
  std::vector<uint8_t> bytes(size_t{2} * kWidth * kHeight);
  cv::RNG random(static_cast<uint64_t>(number) + 1);
  for (uint8_t& byte : bytes) byte = static_cast<uint8_t>(random.uniform(0, 256));
  return bytes;
}

std::vector<uint8_t> luma(const std::vector<uint8_t>& yuyv) {
  std::vector<uint8_t> grey;
  for (size_t i = 0; i < yuyv.size(); i += 2) grey.push_back(yuyv[i]);
  return grey;
}

class LoopbackTest : public CameraSourceTest {
 protected:
  LoopbackTest() {
    options_.width = kWidth;
    options_.height = kHeight;
    options_.rate_hz = kRateHz;
    options_.stall_s = 1;
  }
  void SetUp() override {
    if (access(kFedDevice, F_OK) != 0) GTEST_SKIP() << "v4l2loopback could not be had: MJPEG is NOT tested";
  }
  void begin_feeding(uint32_t fourcc) {
    feeder_.reset();
    feeder_ = std::make_unique<CameraFeeder>(fourcc, kWidth, kHeight, kRateHz);
  }
  std::string open() { return CameraSourceTest::open(kFedDevice); }
  // Feeds the frame and returns the image that the source makes of it; nullopt if none comes.
  std::optional<image_t> pass(const std::vector<uint8_t>& frame) {
    feeder_->write(frame);
    std::vector<image_t> images = take(1, 5 * kSecondUs);
    return images.empty() ? std::nullopt : std::optional(std::move(images[0]));
  }
  std::unique_ptr<CameraFeeder> feeder_;
};

TEST_F(LoopbackTest, MjpegPassesByteForByte) {
  begin_feeding(V4L2_PIX_FMT_MJPEG);
  ASSERT_EQ(open(), "");
  size_t bytes = 0;
  for (int i = 0; i < 30; ++i) {
    const std::vector<uint8_t> frame = jpeg(i);
    const std::optional<image_t> image = pass(frame);
    ASSERT_TRUE(image) << i;
    EXPECT_EQ(image->pixelformat, image_t::PIXEL_FORMAT_MJPEG);
    EXPECT_EQ(check_image(*image).error_text(), "");
    ASSERT_TRUE(image->data == frame) << i;
    bytes += frame.size();
  }
  EXPECT_EQ(source_->skipped().total(), 0);
  std::printf("mjpeg: 30 images, %zu kB, the same to the byte\n", bytes / 1000);
}

TEST_F(LoopbackTest, YuyvPassesByteForByte) {
  begin_feeding(V4L2_PIX_FMT_YUYV);
  ASSERT_EQ(open(), "");
  for (int i = 0; i < 20; ++i) {
    const std::vector<uint8_t> frame = yuyv(i);
    const std::optional<image_t> image = pass(frame);
    ASSERT_TRUE(image) << i;
    EXPECT_EQ(image->pixelformat, image_t::PIXEL_FORMAT_GRAY);
    ASSERT_TRUE(image->data == luma(frame)) << i;
  }
  EXPECT_EQ(source_->skipped().total(), 0);
}

TEST_F(LoopbackTest, BrokenJpegsAreLeftOut) {
  begin_feeding(V4L2_PIX_FMT_MJPEG);
  ASSERT_EQ(open(), "");
  ASSERT_TRUE(pass(jpeg(0)));
  std::vector<uint8_t> half = jpeg(1);
  half.resize(half.size() / 2);
  for (const std::vector<uint8_t>& broken :
       {half, std::vector<uint8_t>(1000, 0xFF), std::vector<uint8_t>{0xFF, 0xD8}}) {
    const int64_t before = source_->skipped().unreadable;
    feeder_->write(broken);
    EXPECT_TRUE(wait_for([&] { return source_->skipped().unreadable == before + 1; }, 5 * kSecondUs));
  }
  const std::optional<image_t> image = pass(jpeg(2));
  ASSERT_TRUE(image);
  EXPECT_TRUE(image->data == jpeg(2));
  EXPECT_EQ(source_->skipped().total(), 3);
}

// The driver keeps only the newest images, but numbers all of them.
TEST_F(LoopbackTest, WhatWeAreTooSlowForIsCounted) {
  begin_feeding(V4L2_PIX_FMT_MJPEG);
  ASSERT_EQ(open(), "");
  ASSERT_TRUE(pass(jpeg(0)));
  int64_t written = 1, received = 1;
  for (const int at_once : {5, 1, 12}) {
    for (int i = 0; i < at_once; ++i) feeder_->write(jpeg(static_cast<int>(written++)));
    const std::vector<image_t> images = take(static_cast<size_t>(at_once), kSecondUs / 2);
    ASSERT_FALSE(images.empty());
    EXPECT_TRUE(images.back().data == jpeg(static_cast<int>(written - 1))) << "the newest";
    received += static_cast<int64_t>(images.size());
    EXPECT_EQ(source_->skipped().lost, written - received);
  }
  EXPECT_GE(source_->skipped().lost, 8);  // the driver keeps at most 4 images
  std::printf("%ld images written, %ld received, %ld counted as lost\n", static_cast<long>(written),
              static_cast<long>(received), static_cast<long>(source_->skipped().lost));
}

TEST_F(LoopbackTest, TimesAreThoseOfTheDriverNotOfOurLooking) {
  constexpr int64_t kLateUs = 300'000;
  begin_feeding(V4L2_PIX_FMT_MJPEG);
  ASSERT_EQ(open(), "");
  feeder_->write(jpeg(0));
  const int64_t written_us = kernel_video_system().now().system_us;
  while (kernel_video_system().now().system_us < written_us + kLateUs) kernel_video_system().wait(10);
  const std::vector<image_t> images = take(1);
  ASSERT_EQ(images.size(), 1u);
  EXPECT_NEAR(static_cast<double>(images[0].utime), static_cast<double>(written_us), kLateUs / 2);
}

TEST_F(LoopbackTest, AShortSilenceIsNoFailure) {
  options_.stall_s = 30;
  begin_feeding(V4L2_PIX_FMT_MJPEG);
  ASSERT_EQ(open(), "");
  ASSERT_TRUE(pass(jpeg(0)));
  feeder_.reset();
  EXPECT_TRUE(take(1, kSecondUs).empty());
  begin_feeding(V4L2_PIX_FMT_MJPEG);
  const std::optional<image_t> image = pass(jpeg(1));
  ASSERT_TRUE(image);
  EXPECT_TRUE(image->data == jpeg(1));
  EXPECT_EQ(source_->live()->problem, "");
}

// The feeding program ends in mid-stream and comes back, once with another format.
TEST_F(LoopbackTest, ACameraThatFallsSilentIsOpenedAgain) {
  begin_feeding(V4L2_PIX_FMT_MJPEG);
  ASSERT_EQ(open(), "");
  ASSERT_TRUE(pass(jpeg(0)));
  for (const uint32_t format : {V4L2_PIX_FMT_MJPEG, V4L2_PIX_FMT_YUYV}) {
    feeder_.reset();
    ASSERT_TRUE(wait_for([&] { return !source_->live()->problem.empty(); }));
    EXPECT_THAT(source_->live()->problem, HasSubstr("no image for 1."));
    EXPECT_TRUE(take(1, kSecondUs).empty());
    EXPECT_THAT(source_->live()->problem, HasSubstr("gives no images")) << "it is no camera while nobody feeds it";
    begin_feeding(format);
    const auto frame = format == V4L2_PIX_FMT_MJPEG ? jpeg : yuyv;
    std::optional<image_t> image;
    for (int i = 0; i < 20 && !image; ++i) {
      feeder_->write(frame(i));
      if (std::vector<image_t> images = take(1, kSecondUs / 2); !images.empty()) image = std::move(images[0]);
    }
    ASSERT_TRUE(image);
    EXPECT_EQ(source_->live()->problem, "");
    take(20, kSecondUs / 2);  // takes the other images that were written meanwhile
    image = pass(frame(30));
    ASSERT_TRUE(image);
    EXPECT_TRUE(image->data == (format == V4L2_PIX_FMT_MJPEG ? jpeg(30) : luma(yuyv(30))));
  }
}

// Feeds frames at the pace of a camera, in a thread.
class Feeding {
 public:
  explicit Feeding(const std::vector<std::vector<uint8_t>>& frames)
      : feeder_(V4L2_PIX_FMT_MJPEG, kWidth, kHeight, kRateHz) {
    thread_ = std::thread([this, &frames] { run(frames); });
  }
  ~Feeding() {
    stop_ = true;
    thread_.join();
  }

 private:
  void run(const std::vector<std::vector<uint8_t>>& frames) {
    for (size_t i = 0; !stop_; ++i) {
      feeder_.write(frames[i % frames.size()]);
      std::this_thread::sleep_for(std::chrono::milliseconds(1000 / kRateHz));
    }
  }
  CameraFeeder feeder_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

TEST_F(LoopbackTest, TheProcessOnLcm) {
  std::ofstream("/run/fed_camera.yaml") << "fx: 500\nfy: 500\ncx: 320\ncy: 240\nwidth: 640\nheight: 480\nfps: 15\n";
  const Result<std::unique_ptr<LcmBus>> opened = LcmBus::open(kDefaultLcmUrl, {});
  ASSERT_TRUE(opened) << opened.error_text();
  const std::unique_ptr<LcmBus>& bus = *opened;
  std::vector<std::vector<uint8_t>> frames;
  for (int i = 0; i < 15; ++i) frames.push_back(jpeg(i));
  int64_t images = 0, others = 0, too_long = 0;
  process_status_t status{};
  bus->subscribe<image_t>(channels::kCamera, {}, [&](const image_t& image) {
    ++images;
    const auto known = std::find_if(frames.begin(), frames.end(), [&image](const std::vector<uint8_t>& frame) {
      return image.data.size() >= frame.size() && std::equal(frame.begin(), frame.end(), image.data.begin());
    });
    others += known == frames.end();
    too_long += known != frames.end() && image.data.size() > known->size();
  });
  bus->subscribe<process_status_t>(channels::kStatus, {}, [&](const process_status_t& message) { status = message; });
  const auto until = [&bus](const std::function<bool()>& condition) { return hear_until(*bus, condition); };
  auto feeding = std::make_unique<Feeding>(frames);
  Process process({kFedDevice, "--camera", "/run/fed_camera.yaml", "--set", "camera_driver.stall=1"});
  ASSERT_TRUE(until([&] { return images >= 45; }));
  feeding.reset();
  EXPECT_TRUE(until([&] { return status.state == process_status_t::DEGRADED; }));
  EXPECT_THAT(status.detail, HasSubstr("no images now"));
  const int64_t before = images;
  feeding = std::make_unique<Feeding>(frames);
  EXPECT_TRUE(until([&] { return images > before + 30 && status.state == process_status_t::RUNNING; }));
  EXPECT_EQ(others, 0);
  EXPECT_LE(too_long, 2) << "v4l2loopback forgets how long its images are when it is opened";
  std::printf("process: %ld MJPEG images over LCM as they were written, status: %s\n", static_cast<long>(images),
              status.detail.c_str());
  EXPECT_EQ(process.end(SIGTERM), 0);
}

}  // namespace
}  // namespace rumi::camera_driver
