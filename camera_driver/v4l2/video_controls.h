// SPDX-License-Identifier: BSD-3-Clause
// A camera's controls by name and range: exposure, gain, white balance, focus, and whatever else it has.
#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "camera_driver/source/camera_options.h"
#include "camera_driver/v4l2/video_device.h"

namespace rumi::camera_driver {

struct VideoControl {
  uint32_t id = 0;
  std::string name;  // as v4l2-ctl writes it: "white_balance_automatic"
  int64_t min = 0, max = 0, step = 1, preset = 0;
  std::vector<std::pair<int64_t, std::string>> menu;
  bool settable = true;  // false: read-only, or not a number
};

std::vector<VideoControl> controls_of(const VideoDevice& device);
// Returns nullopt if the control cannot be read.
std::optional<int32_t> read_control(const VideoDevice& device, uint32_t id);

// Sets the controls that the options name. Returns a line for each one that could not be set: a camera without some
// control can still be used.
std::vector<std::string> apply_controls(const VideoDevice& device, const CameraControls& controls);
// Fixes exposure, gain and white balance at their present values. Returns a line for the log: what was fixed, and what
// could not be.
std::string lock_automatic(const VideoDevice& device);

using ControlList = std::vector<std::pair<std::string, int32_t>>;
// Parses "brightness=10, sharpness=0"; an Error names the item that is not NAME=NUMBER.
Result<ControlList> parse_control_list(const std::string& text);

}  // namespace rumi::camera_driver
