// SPDX-License-Identifier: BSD-3-Clause
// feed_camera RECORDING RATE_HZ IMAGES: the images of a recording, again and again, become those of v4l2loopback's
// virtual camera. It is a camera from the first line of output on; the images come after a line on standard input, so
// that whoever is to see all of them has the time to start.
#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <stdexcept>
#include <thread>

#include "camera_driver/image_source.h"
#include "camera_feeder.h"

namespace {

using Clock = std::chrono::steady_clock;

void feed(const char* recording, uint32_t rate_hz, int64_t images) {
  rumi::CameraOptions options;
  options.loop = true;
  const rumi::OpenedSource opened = rumi::open_recording(recording, options);
  if (!opened.ok()) throw std::runtime_error(opened.error);
  rumi::ImageSource& source = *opened.source;
  std::optional<rumi::image_t> image = source.next();
  if (!image) throw std::runtime_error(fmt::format("{} has no images", recording));
  const bool is_jpeg = image->pixelformat == rumi::image_t::PIXEL_FORMAT_MJPEG;
  rumi::testing::CameraFeeder feeder(is_jpeg ? V4L2_PIX_FMT_MJPEG : V4L2_PIX_FMT_GREY, image->width, image->height,
                                     rate_hz);
  fmt::print("{} waits to be fed\n", rumi::testing::kFedDevice);
  std::fflush(stdout);
  std::getchar();
  const Clock::time_point start = Clock::now();
  int64_t fed = 0;
  for (; fed < images && image; ++fed) {
    std::this_thread::sleep_until(start + fed * std::chrono::microseconds(1'000'000) / rate_hz);
    feeder.write(image->data);
    image = source.next();
  }
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  fmt::print("{} images fed in {:.1f} s\n", fed, seconds);
}

}  // namespace

int main(int argc, char** argv) {
  const int rate_hz = argc == 4 ? std::atoi(argv[2]) : 0;
  if (rate_hz <= 0) {
    fmt::print(stderr, "usage: feed_camera RECORDING RATE_HZ IMAGES\n");
    return 2;
  }
  try {
    feed(argv[1], static_cast<uint32_t>(rate_hz), std::atoll(argv[3]));
  } catch (const std::exception& e) {
    fmt::print(stderr, "feed_camera: {}\n", e.what());
    return 1;
  }
}
