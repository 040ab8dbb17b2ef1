// SPDX-License-Identifier: BSD-3-Clause
// Fixture with a fake camera, which fails in ways in which the kernel cannot be made to fail.
#pragma once

#include <gmock/gmock.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bus/wire/jpeg_image.h"
#include "camera_driver/v4l2/v4l2_source.h"
#include "tests/camera_driver/v4l2/fake_camera.h"
#include "tests/formats/recording.h"

namespace rumi::testing {
using namespace rumi::camera_driver;

inline constexpr int kWidth = 64, kHeight = 48;

inline std::vector<uint8_t> grey_frame(int number) {
  const cv::Mat grey = picture(number, kWidth, kHeight);
  return {grey.datastart, grey.dataend};
}

inline std::vector<uint8_t> jpeg_frame(int width = kWidth, int height = kHeight) {
  return make_jpeg_image(0, picture(1, width, height)).data;
}

class V4l2SourceTest : public ::testing::Test {
 protected:
  V4l2SourceTest() {
    options_.width = kWidth;
    options_.height = kHeight;
  }
  ~V4l2SourceTest() override {
    source_.reset();
    EXPECT_EQ(fake_.open_count, 0);
    EXPECT_EQ(fake_.mapped_count, 0);
  }
  // Opens the camera. Returns why it cannot be used, or an empty string.
  std::string open(const std::string& input = "/dev/video0") {
    OpenedSource opened = open_camera(fake_, input, options_);
    source_ = opened ? std::move(*opened) : nullptr;
    return opened.error_text();
  }
  // Returns all images that come within `us` of the fake's time.
  std::vector<image_t> images_within(int64_t us) {
    std::vector<image_t> images;
    const int64_t end = fake_.clocks.monotonic_us + us;
    while (fake_.clocks.monotonic_us < end) {
      std::optional<image_t> image = source_->next();
      if (image) images.push_back(std::move(*image));
      if (source_->live()->ended) break;
    }
    return images;
  }
  FakeCamera fake_;
  CameraOptions options_;
  std::unique_ptr<ImageSource> source_;
};

}  // namespace rumi::testing
