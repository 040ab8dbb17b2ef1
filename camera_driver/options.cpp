// SPDX-License-Identifier: BSD-3-Clause
#include "camera_driver/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

#include "base/text/number_text.h"
#include "camera_driver/v4l2/pixel_format.h"
#include "camera_driver/v4l2/video_controls.h"
#include "formats/image/image_file.h"
#include "slam/geometry/max_side.h"

namespace rumi::camera_driver {
namespace {

constexpr int kMaxEvery = 1'000'000;
constexpr double kMaxSeconds = 1e9;
constexpr double kMaxRateHz = 10'000;
constexpr double kMinSpeed = 0.001, kMaxSpeed = 10'000;

// True if the value lies between the limits; false also for NaN.
bool within(double value, double min, double max) { return value >= min && value <= max; }

constexpr double kMaxLockS = 3600, kMinStallS = 0.1, kMaxStallS = 600;
constexpr double kMaxControl = 1e6;

// An Error unless the value is empty, "auto", or a number from `min` to kMaxControl.
Result<> check_control(const char* name, const std::string& value, double min) {
  if (value.empty() || value == "auto") return {};
  const auto number = parse_number<double>(value);
  if (number && within(*number, min, kMaxControl)) return {};
  return Error{
      fmt::format("camera_driver.{} is '{}': must be auto or a number from {} to {}", name, value, min, kMaxControl)};
}

std::vector<std::string> format_choices() {
  std::vector<std::string> choices = {"auto"};
  for (const PixelFormat& format : pixel_formats()) choices.push_back(format.option);
  return choices;
}

Result<> check_camera_options(const CameraOptions& o) {
  constexpr double kMinExposureMs = 0.1;
  if (!within(o.width, 0, kMaxSide)) return Error{fmt::format("width is {}: must be 0 to {}", o.width, kMaxSide)};
  if (!within(o.height, 0, kMaxSide)) return Error{fmt::format("height is {}: must be 0 to {}", o.height, kMaxSide)};
  if ((o.width == 0) != (o.height == 0))
    return Error{fmt::format("camera_driver.width x height is {} x {}: give both or none", o.width, o.height)};
  const std::vector<std::string> formats = format_choices();
  if (std::find(formats.begin(), formats.end(), o.format) == formats.end())
    return Error{fmt::format("format is '{}': must be {}", o.format, fmt::join(formats, ", "))};
  for (const Result<>& checked :
       {check_control("exposure", o.exposure, kMinExposureMs), check_control("gain", o.gain, -kMaxControl),
        check_control("white_balance", o.white_balance, 0), check_control("focus", o.focus, -kMaxControl)})
    if (!checked) return checked;
  if (const Result<ControlList> controls = parse_control_list(o.controls); !controls) return controls.error();
  if (!within(o.lock_auto_s, 0, kMaxLockS))
    return Error{fmt::format("lock_auto is {}: must be 0 (never) to {} s", o.lock_auto_s, kMaxLockS)};
  if (!within(o.stall_s, kMinStallS, kMaxStallS))
    return Error{fmt::format("stall is {}: must be {} to {} s", o.stall_s, kMinStallS, kMaxStallS)};
  return {};
}

}  // namespace

Result<> check(const CameraOptions& o) {
  static constexpr std::array kEncodings = {"auto", "grey", "rgb", "jpeg"};
  if (o.every < 1 || o.every > kMaxEvery) return Error{fmt::format("every is {}: must be 1 to {}", o.every, kMaxEvery)};
  if (!within(o.start_s, 0, kMaxSeconds))
    return Error{fmt::format("start is {}: must be 0 or more seconds", o.start_s)};
  if (!within(o.duration_s, 0, kMaxSeconds))
    return Error{fmt::format("duration is {}: must be 0 (all) or more seconds", o.duration_s)};
  if (!within(o.rate_hz, 0, kMaxRateHz))
    return Error{fmt::format("rate is {}: must be 0 (as recorded) to {} Hz", o.rate_hz, kMaxRateHz)};
  if (!within(o.speed, kMinSpeed, kMaxSpeed))
    return Error{fmt::format("speed is {}: must be {} to {}", o.speed, kMinSpeed, kMaxSpeed)};
  if (std::find(kEncodings.begin(), kEncodings.end(), o.encoding) == kEncodings.end())
    return Error{fmt::format("encoding is '{}': must be {}", o.encoding, fmt::join(kEncodings, ", "))};
  if (o.grey_range != "auto" && !parse_grey_range(o.grey_range))
    return Error{fmt::format("camera_driver.grey_range is '{}': must be auto or LOW:HIGH, 0 to 65535", o.grey_range)};
  return check_camera_options(o);
}

void describe(OptionTable& table, CameraOptions& o) {
  table.group("camera_driver");
  table.add(
      "camera_driver.camera_file", &o.camera_file,
      "calibration file (FILE:cam1: one of its cameras); empty: beside the data, or in the log; a camera without one "
      "cannot be tracked");
  table.add("camera_driver.mask", &o.mask,
            "PNG, black where an image does not show the world, or a folder with one an image; empty: beside the data, "
            "or in the log; none: no mask");
  table.add("camera_driver.every", &o.every, "", "publish every Nth image only", 1, kMaxEvery);
  table.add("camera_driver.start", &o.start_s, "s", "leave out so much at the beginning", 0, kMaxSeconds);
  table.add("camera_driver.duration", &o.duration_s, "s", "end after so much of the recording; 0: all of it", 0,
            kMaxSeconds);
  table.add("camera_driver.loop", &o.loop, "begin again at the end; times keep rising");
  table.add("camera_driver.rate", &o.rate_hz, "Hz",
            "recording: new times at this rate, 0: as recorded; camera: asked for, 0: fps of the calibration, else 30",
            0, kMaxRateHz);
  table.add("camera_driver.speed", &o.speed, "", "live: pace relative to the times", kMinSpeed, kMaxSpeed);
  table.add("camera_driver.live_stamps", &o.live_stamps, "live: the time of an image is when it is published");
  table.add("camera_driver.encoding", &o.encoding, "on the wire; auto: JPEG files as they are, all else grey",
            {"auto", "grey", "rgb", "jpeg"});
  table.add("camera_driver.log_channel", &o.log_channel, "channel of the images in an lcm log; topic in a ROS bag");
  table.add("camera_driver.files", &o.files,
            "pattern (* and ?) of the images of a folder or list; empty: those of one camera");
  table.add("camera_driver.grey_range", &o.grey_range,
            "pixels of 16 bits: LOW:HIGH become 0 to 255; auto: the range of the recording");
  table.add("camera_driver.width", &o.width, "px",
            "camera: of its images; 0: as the calibration says, without one 640 x 480", 0, kMaxSide);
  table.add("camera_driver.height", &o.height, "px",
            "camera: of its images; 0: as the calibration says, without one 640 x 480", 0, kMaxSide);
  table.add("camera_driver.format", &o.format, "camera: pixel format; auto: reaches the rate with least work and loss",
            format_choices());
  table.add("camera_driver.exposure", &o.exposure, "camera: auto, or ms; empty: as it is");
  table.add("camera_driver.gain", &o.gain, "camera: auto, or the camera's number (--list); empty: as it is");
  table.add("camera_driver.white_balance", &o.white_balance, "camera: auto, or kelvin; empty: as it is");
  table.add("camera_driver.focus", &o.focus, "camera: auto, or the camera's number (--list); empty: as it is");
  table.add("camera_driver.power_line", &o.power_line, "camera: frequency of the lamps, Hz; empty: as it is",
            {"", "off", "50", "60", "auto"});
  table.add("camera_driver.controls", &o.controls,
            "camera: any other controls (--list): \"brightness=10, sharpness=0\"");
  table.add("camera_driver.lock_auto", &o.lock_auto_s, "s",
            "camera: exposure, gain and white balance stay as they are after so long; 0: never", 0, kMaxLockS);
  table.add("camera_driver.stall", &o.stall_s, "s", "camera: opened again after so long without an image", kMinStallS,
            kMaxStallS);
  table.for_users({"camera_driver.camera_file", "camera_driver.mask",          "camera_driver.every",
                   "camera_driver.start",       "camera_driver.duration",      "camera_driver.loop",
                   "camera_driver.rate",        "camera_driver.speed",         "camera_driver.encoding",
                   "camera_driver.files",       "camera_driver.grey_range",    "camera_driver.width",
                   "camera_driver.height",      "camera_driver.format",        "camera_driver.exposure",
                   "camera_driver.gain",        "camera_driver.white_balance", "camera_driver.focus",
                   "camera_driver.power_line",  "camera_driver.controls",      "camera_driver.lock_auto"});
}

}  // namespace rumi::camera_driver
