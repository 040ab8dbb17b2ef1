// SPDX-License-Identifier: BSD-3-Clause
// feed_camera RECORDING RATE_HZ IMAGES: v4l2loopback's virtual camera shows the images of a recording, again and again.
// It is a camera as soon as the first line is printed. The images begin after a line on standard input, so that a
// program that must see all of them has time to start.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "camera_driver/open_source.h"
#include "tests/camera_driver/v4l2/kernel/camera_feeder.h"

namespace {

using Clock = std::chrono::steady_clock;

// Reads all images into memory. Reading them while they are fed would delay them where files are slow, as in a virtual
// machine.
std::vector<rumi::image_t> read(const char* recording, size_t at_most) {
  const rumi::camera_driver::OpenedSource opened = rumi::camera_driver::open_recording(recording, {});
  if (!opened.has_value()) throw std::runtime_error(opened.error_text());
  std::vector<rumi::image_t> images;
  while (images.size() < at_most) {
    std::optional<rumi::image_t> image = (*opened)->next();
    if (!image) break;
    images.push_back(std::move(*image));
  }
  if (images.empty()) throw std::runtime_error(fmt::format("{} has no images", recording));
  return images;
}

void feed(const std::vector<rumi::image_t>& images, uint32_t rate_hz, size_t n) {
  const bool is_jpeg = images[0].pixelformat == rumi::image_t::PIXEL_FORMAT_MJPEG;
  rumi::testing::CameraFeeder feeder(is_jpeg ? V4L2_PIX_FMT_MJPEG : V4L2_PIX_FMT_GREY, images[0].width,
                                     images[0].height, rate_hz);
  fmt::print("{} waits to be fed\n", rumi::testing::kFedDevice);
  std::fflush(stdout);
  std::getchar();
  const Clock::time_point start = Clock::now();
  std::chrono::duration<double> latest{};  // greatest delay of an image
  for (size_t i = 0; i < n; ++i) {
    const Clock::time_point due = start + i * std::chrono::microseconds(1'000'000) / rate_hz;
    std::this_thread::sleep_until(due);
    latest = std::max<std::chrono::duration<double>>(latest, Clock::now() - due);
    feeder.write(images[i % images.size()].data);
  }
  fmt::print("{} images fed, at most {:.2f} s late\n", n, latest.count());
}

}  // namespace

int main(int argc, char** argv) {
  const int rate_hz = argc == 4 ? std::atoi(argv[2]) : 0;
  if (rate_hz <= 0) {
    fmt::print(stderr, "usage: feed_camera RECORDING RATE_HZ IMAGES\n");
    return 2;
  }
  try {
    const size_t n = std::strtoul(argv[3], nullptr, 10);
    feed(read(argv[1], n), static_cast<uint32_t>(rate_hz), n);
  } catch (const std::exception& e) {
    fmt::print(stderr, "feed_camera: {}\n", e.what());
    return 1;
  }
}
