// SPDX-License-Identifier: BSD-3-Clause
// Tests a camera that is opened, set up, pulled out, and put in again.
#include "camera_driver/v4l2/v4l2_source.h"

#include <gmock/gmock.h>

#include "bus/transport/memory_bus.h"
#include "camera_driver/camera_node.h"
#include "tests/camera_driver/v4l2/v4l2_source_fixture.h"

namespace rumi::camera_driver {
namespace {

using namespace testing;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;

TEST_F(V4l2SourceTest, ACameraThatIsPulledOutIsOpenedAgainWhenItIsBack) {
  ASSERT_EQ(open(), "");
  fake_.add_frames(2, 0, grey_frame(1));
  EXPECT_EQ(images_within(60'000).size(), 2u);
  FakeFrame gone;
  gone.error = ENODEV;
  fake_.frames = {gone};
  fake_.open_error = ENOENT;
  fake_.waited_us = 0;
  fake_.opened_times = 0;
  EXPECT_THAT(images_within(60'000'000), IsEmpty());
  EXPECT_THAT(source_->live()->problem, HasSubstr("there is no such camera"));
  EXPECT_EQ(fake_.open_count, 0);
  EXPECT_LT(fake_.opened_times, 20);  // it is tried now and then, not all the time
  EXPECT_GT(fake_.opened_times, 10);
  fake_.open_error = 0;
  fake_.add_frames(1, 0, grey_frame(2));
  fake_.frames.back().stamp_us = fake_.clocks.monotonic_us;
  const std::vector<image_t> images = images_within(6'000'000);
  ASSERT_EQ(images.size(), 1u);
  EXPECT_EQ(images[0].data, grey_frame(2));
  EXPECT_EQ(source_->live()->problem.substr(0, 40).find("there is no such"), std::string::npos);
}

TEST_F(V4l2SourceTest, AnotherCameraAtTheSamePlaceIsNotTakenForIt) {
  ASSERT_EQ(open(), "");
  FakeFrame gone;
  gone.error = ENODEV;
  fake_.frames = {gone};
  fake_.card = "Other Webcam";
  fake_.add_frames(5, 0, grey_frame(1));
  EXPECT_THAT(images_within(2'000'000), IsEmpty());
  EXPECT_THAT(source_->live()->problem, AllOf(HasSubstr("Other Webcam"), HasSubstr("Fake Webcam")));
}

TEST_F(V4l2SourceTest, ErrorsWhileStreamingOpenItAgain) {
  for (const int error : {EIO, EINVAL, EPIPE}) {
    ASSERT_EQ(open(), "");
    FakeFrame bad;
    bad.error = error;
    fake_.frames = {bad};
    fake_.add_frames(30, 0, grey_frame(1));
    EXPECT_GT(images_within(2'000'000).size(), 20u) << std::strerror(error);
    EXPECT_EQ(source_->live()->problem, "");
    source_.reset();
    fake_.frames.clear();
  }
}

TEST_F(V4l2SourceTest, ABufferThatThereIsNotOpensItAgain) {
  ASSERT_EQ(open(), "");
  fake_.add_frames(1, 0, grey_frame(1));
  fake_.frames[0].wrong_index = 77;
  fake_.add_frames(30, 1, grey_frame(1));
  EXPECT_GT(images_within(2'000'000).size(), 20u);
  EXPECT_EQ(fake_.opened_times, 2);
}

TEST_F(V4l2SourceTest, SilenceIsNoticed) {
  ASSERT_EQ(open(), "");
  fake_.opened_times = 0;
  EXPECT_THAT(images_within(2'900'000), IsEmpty());
  EXPECT_EQ(fake_.opened_times, 0);
  EXPECT_THAT(images_within(1'000'000), IsEmpty());
  EXPECT_EQ(fake_.opened_times, 1);
  EXPECT_THAT(source_->live()->problem, HasSubstr("no image for 3.0 s"));
  fake_.add_frames(1, 0, grey_frame(1));
  EXPECT_EQ(images_within(100'000).size(), 1u);
  EXPECT_EQ(source_->live()->problem, "");
}

TEST_F(V4l2SourceTest, ABusyCameraIsWaitedForFromTheStart) {
  for (const unsigned long request : {VIDIOC_S_FMT, VIDIOC_REQBUFS, VIDIOC_STREAMON}) {
    fake_.errors[request] = EBUSY;
    ASSERT_EQ(open(), "");
    EXPECT_THAT(images_within(1'000'000), IsEmpty());
    EXPECT_THAT(source_->live()->problem, HasSubstr("in use by another program"));
    fake_.errors.clear();
    fake_.add_frames(60, 0, grey_frame(1));
    EXPECT_GT(images_within(3'000'000).size(), 5u);
    source_.reset();
    fake_.frames.clear();
  }
}

TEST_F(V4l2SourceTest, WhatCannotWorkIsSaidAtTheStart) {
  fake_.open_error = EACCES;
  EXPECT_THAT(open(), AllOf(HasSubstr("group 'video'"), HasSubstr("usermod -aG video")));
  fake_.open_error = 0;
  EXPECT_THAT(open("/dev/video7"), AllOf(HasSubstr("/dev/video7"), HasSubstr("/dev/video0")));
  options_.width = 100;
  EXPECT_THAT(open(), AllOf(HasSubstr("100 x 48"), HasSubstr("64 x 48")));
  options_.width = kWidth;
  options_.format = "yuyv";
  EXPECT_THAT(open(), AllOf(HasSubstr("yuyv"), HasSubstr("grey")));
  options_.format = "auto";
  fake_.errors[VIDIOC_STREAMON] = ENOSPC;
  EXPECT_THAT(open(), HasSubstr("bandwidth"));
  fake_.errors.clear();
  fake_.capabilities = V4L2_CAP_META_CAPTURE;
  EXPECT_THAT(open(), HasSubstr("gives no images"));
  fake_.capabilities = V4L2_CAP_VIDEO_CAPTURE_MPLANE | V4L2_CAP_STREAMING;
  EXPECT_THAT(open(), HasSubstr("multi-planar"));
  fake_.capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
  fake_.errors[VIDIOC_QUERYCAP] = ENOTTY;
  EXPECT_THAT(open(), HasSubstr("is not a camera"));
  options_.loop = true;
  EXPECT_THAT(open(), HasSubstr("loop"));
}

TEST_F(V4l2SourceTest, AbsurdAnswersAreRefused) {
  struct Case {
    const char* name;
    std::function<void(unsigned long, void*)> tamper;
  };
  const std::vector<Case> cases = {
      {"size",
       [](unsigned long r, void* a) {
         if (r == VIDIOC_S_FMT) static_cast<v4l2_format*>(a)->fmt.pix.width = 1u << 31;
       }},
      {"format",
       [](unsigned long r, void* a) {
         if (r == VIDIOC_S_FMT) static_cast<v4l2_format*>(a)->fmt.pix.pixelformat = 0;
       }},
      {"stride",
       [](unsigned long r, void* a) {
         if (r == VIDIOC_S_FMT) static_cast<v4l2_format*>(a)->fmt.pix.bytesperline = 63;
       }},
      {"stride",
       [](unsigned long r, void* a) {
         if (r == VIDIOC_S_FMT) static_cast<v4l2_format*>(a)->fmt.pix.bytesperline = ~0u;
       }},
      {"fields",
       [](unsigned long r, void* a) {
         if (r == VIDIOC_S_FMT) static_cast<v4l2_format*>(a)->fmt.pix.field = V4L2_FIELD_ALTERNATE;
       }},
      {"buffers",
       [](unsigned long r, void* a) {
         if (r == VIDIOC_REQBUFS) static_cast<v4l2_requestbuffers*>(a)->count = 0;
       }},
      {"buffers",
       [](unsigned long r, void* a) {
         if (r == VIDIOC_REQBUFS) static_cast<v4l2_requestbuffers*>(a)->count = 1u << 30;
       }},
      {"length",
       [](unsigned long r, void* a) {
         if (r == VIDIOC_QUERYBUF) static_cast<v4l2_buffer*>(a)->length = 0;
       }},
      {"length",
       [](unsigned long r, void* a) {
         if (r == VIDIOC_QUERYBUF) static_cast<v4l2_buffer*>(a)->length = ~0u;
       }},
  };
  for (const Case& test : cases) {
    fake_.tamper = test.tamper;
    EXPECT_NE(open(), "") << test.name;
    EXPECT_EQ(fake_.open_count, 0) << test.name;
  }
}

TEST_F(V4l2SourceTest, TheFormatThatReachesTheRateIsChosen) {
  fake_.formats = {{V4L2_PIX_FMT_MJPEG, {{64, 48}}, 30},
                   {V4L2_PIX_FMT_YUYV, {{64, 48}}, 10},
                   {V4L2_PIX_FMT_GREY, {{32, 24}}, 30},
                   {v4l2_fourcc('Z', '1', '6', ' '), {{64, 48}}, 90}};
  uint32_t chosen = 0;
  fake_.tamper = [&chosen](unsigned long request, void* argument) {
    if (request == VIDIOC_S_FMT) chosen = static_cast<v4l2_format*>(argument)->fmt.pix.pixelformat;
  };
  ASSERT_EQ(open(), "");
  EXPECT_EQ(chosen, V4L2_PIX_FMT_MJPEG);  // YUYV is preferred, but too slow
  options_.rate_hz = 10;
  ASSERT_EQ(open(), "");
  EXPECT_EQ(chosen, V4L2_PIX_FMT_YUYV);
  options_.rate_hz = 60;
  ASSERT_EQ(open(), "");
  EXPECT_EQ(chosen, V4L2_PIX_FMT_MJPEG);  // no format reaches the rate: the fastest is chosen
}

TEST_F(V4l2SourceTest, ControlsAreSetAtTheStartAndWhileItRuns) {
  fake_.controls = {
      {V4L2_CID_BRIGHTNESS, {"Brightness", 0, 255, 128}},
      {V4L2_CID_AUTO_WHITE_BALANCE, {"White Balance, Automatic", 0, 1, 1}},
      {V4L2_CID_WHITE_BALANCE_TEMPERATURE, {"White Balance Temperature", 2800, 6500, 4000}},
      {V4L2_CID_GAIN, {"Gain", 0, 100, 0}},
      {V4L2_CID_POWER_LINE_FREQUENCY, {"Power Line Frequency", 0, 3, 2, V4L2_CTRL_TYPE_MENU, 0, {0, 1, 2, 3}}},
      {V4L2_CID_EXPOSURE_AUTO, {"Auto Exposure", 0, 3, 3, V4L2_CTRL_TYPE_MENU, 0, {1, 3}}},
      {V4L2_CID_EXPOSURE_ABSOLUTE, {"Exposure Time, Absolute", 1, 5000, 157}},
  };
  options_.exposure = "8";
  options_.gain = "30";
  options_.white_balance = "3000";
  options_.power_line = "50";
  options_.controls = "brightness=10";
  ASSERT_EQ(open(), "");
  EXPECT_THAT(fake_.set_controls,
              ElementsAre(Pair("Auto Exposure", 1), Pair("Exposure Time, Absolute", 80), Pair("Gain", 30),
                          Pair("White Balance, Automatic", 0), Pair("White Balance Temperature", 3000),
                          Pair("Power Line Frequency", 1), Pair("Brightness", 10)));
  fake_.add_frames(1, 0, grey_frame(1));
  const int64_t middle_us = fake_.frames[0].stamp_us + fake_.offset_us() + 4000;
  EXPECT_EQ(images_within(50'000).at(0).utime, middle_us);  // the stamp is the start of an exposure of 8 ms

  fake_.set_controls.clear();
  CameraOptions changed = options_;
  changed.exposure = "auto";
  changed.gain = "1000";
  changed.white_balance = changed.power_line = "";
  changed.controls = "brightnes=10";  // one that cannot be set does not keep the others from being set
  changed.focus = "3";
  source_->set_controls(changed);
  EXPECT_THAT(fake_.set_controls, ElementsAre(Pair("Auto Exposure", 3)));
}

TEST_F(V4l2SourceTest, AutomaticExposureIsLockedAfterTheWarmUp) {
  fake_.controls = {
      {V4L2_CID_AUTOGAIN, {"Gain, Automatic", 0, 1, 1}},
      {V4L2_CID_GAIN, {"Gain", 0, 100, 17}},
      {V4L2_CID_EXPOSURE_AUTO, {"Auto Exposure", 0, 3, 3, V4L2_CTRL_TYPE_MENU, 0, {1, 3}}},
      {V4L2_CID_EXPOSURE_ABSOLUTE, {"Exposure Time, Absolute", 1, 5000, 157}},
  };
  options_.lock_auto_s = 1;
  ASSERT_EQ(open(), "");
  fake_.add_frames(60, 0, grey_frame(1));
  images_within(900'000);
  EXPECT_THAT(fake_.set_controls, IsEmpty());
  fake_.controls[V4L2_CID_EXPOSURE_ABSOLUTE].value = 200;
  images_within(1'000'000);
  EXPECT_THAT(fake_.set_controls, ElementsAre(Pair("Auto Exposure", 1), Pair("Exposure Time, Absolute", 200),
                                              Pair("Gain, Automatic", 0), Pair("Gain", 17)));
}

TEST_F(V4l2SourceTest, IsFoundByNameAndListed) {
  EXPECT_EQ(open("camera:webcam"), "");
  EXPECT_EQ(open("camera:0042"), "");
  EXPECT_THAT(open("camera:other"), HasSubstr("Fake Webcam"));
  fake_.formats.push_back({v4l2_fourcc('Z', '1', '6', ' '), {{64, 48}}, 90});
  fake_.controls = {{V4L2_CID_BRIGHTNESS, {"Brightness", 0, 255, 128}}};
  const std::string list = list_cameras(fake_);
  for (const char* part : {"/dev/video0  'Fake Webcam' (fake, usb-1)", "/dev/v4l/by-id/usb-Fake-0042", "grey (GREY)",
                           "64 x 48: 30 Hz", "does not understand: Z16", "brightness", "0 .. 255", "now 128"})
    EXPECT_THAT(list, HasSubstr(part));
}

TEST_F(V4l2SourceTest, TheNodePublishesWhatComesAndTellsWhatDoesNot) {
  ASSERT_EQ(open(), "");
  MemoryBus bus;
  std::vector<image_t> images;
  bus.subscribe<image_t>(channels::kCamera, {}, [&images](const image_t& image) { images.push_back(image); });
  CameraNode node(bus, std::move(source_), options_);
  fake_.add_frames(3, 0, grey_frame(1));
  FakeFrame gone;
  gone.error = ENODEV;
  gone.arrives_us = fake_.frames.back().arrives_us;
  fake_.frames.push_back(gone);
  for (int i = 0; i < 12; ++i) {
    bus.set_now_us(fake_.clocks.system_us);
    EXPECT_EQ(node.next_tick_us(fake_.clocks.system_us), fake_.clocks.system_us);
    node.tick(fake_.clocks.system_us);
    bus.dispatch();
  }
  EXPECT_EQ(images.size(), 3u);
  EXPECT_FALSE(node.done());
  EXPECT_TRUE(node.status().degraded);
  EXPECT_THAT(node.status().detail, AllOf(HasSubstr("3 images"), HasSubstr("the camera is gone")));
}

TEST_F(V4l2SourceTest, EndsAfterTheDuration) {
  options_.duration_s = 0.1;
  options_.every = 2;
  ASSERT_EQ(open(), "");
  fake_.add_frames(10, 0, grey_frame(1));
  EXPECT_EQ(images_within(1'000'000).size(), 2u);
  EXPECT_TRUE(source_->live()->ended);
}

}  // namespace
}  // namespace rumi::camera_driver
