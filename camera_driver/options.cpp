// SPDX-License-Identifier: BSD-3-Clause
#include "camera_driver/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

namespace rumi {
namespace {

constexpr int kMaxEvery = 1'000'000;
constexpr double kMaxSeconds = 1e9;
constexpr double kMaxRateHz = 10'000;
constexpr double kMinSpeed = 0.001, kMaxSpeed = 10'000;

// Also false for NaN.
bool within(double value, double min, double max) { return value >= min && value <= max; }

}  // namespace

std::string CameraOptions::check() const {
  static constexpr std::array kEncodings = {"auto", "grey", "rgb", "jpeg"};
  if (every < 1 || every > kMaxEvery) return fmt::format("every is {}: must be 1 to {}", every, kMaxEvery);
  if (!within(start_s, 0, kMaxSeconds)) return fmt::format("start is {}: must be 0 or more seconds", start_s);
  if (!within(duration_s, 0, kMaxSeconds))
    return fmt::format("duration is {}: must be 0 (all) or more seconds", duration_s);
  if (!within(rate_hz, 0, kMaxRateHz))
    return fmt::format("rate is {}: must be 0 (as recorded) to {} Hz", rate_hz, kMaxRateHz);
  if (!within(speed, kMinSpeed, kMaxSpeed))
    return fmt::format("speed is {}: must be {} to {}", speed, kMinSpeed, kMaxSpeed);
  if (!within(jpeg_quality, 1, 100)) return fmt::format("jpeg_quality is {}: must be 1 to 100", jpeg_quality);
  if (std::find(kEncodings.begin(), kEncodings.end(), encoding) == kEncodings.end())
    return fmt::format("encoding is '{}': must be {}", encoding, fmt::join(kEncodings, ", "));
  return {};
}

void describe(OptionTable& table, CameraOptions& o) {
  table.add("camera_driver.camera_file", &o.camera_file, "calibration file; empty: beside the data, or in the log");
  table.add("camera_driver.every", &o.every, "frames", "publish every Nth frame", 1, kMaxEvery);
  table.add("camera_driver.start", &o.start_s, "s", "leave out so much at the beginning", 0, kMaxSeconds);
  table.add("camera_driver.duration", &o.duration_s, "s", "end after so much of the recording; 0: all of it", 0,
            kMaxSeconds);
  table.add("camera_driver.loop", &o.loop, "begin again at the end; times keep rising");
  table.add("camera_driver.rate", &o.rate_hz, "Hz", "new times at this rate; 0: as recorded", 0, kMaxRateHz);
  table.add("camera_driver.speed", &o.speed, "", "live: pace relative to the times", kMinSpeed, kMaxSpeed);
  table.add("camera_driver.live_stamps", &o.live_stamps, "live: the time of an image is when it is published");
  table.add("camera_driver.encoding", &o.encoding, "on the wire; auto: JPEG files as they are, all else grey",
            {"auto", "grey", "rgb", "jpeg"});
  table.add("camera_driver.jpeg_quality", &o.jpeg_quality, "%", "of encoding jpeg", 1, 100);
  table.add("camera_driver.log_channel", &o.log_channel, "channel of the images in an lcm log");
}

}  // namespace rumi
