// SPDX-License-Identifier: BSD-3-Clause
#include "camera_driver/flags.h"

#include <algorithm>
#include <array>
#include <functional>

#include "base/command_line/options.h"

namespace rumi::camera_driver {
namespace {

struct ShortFlag {
  // Without a type, the flag has no value and sets the option to true. `value`: the default that the help shows.
  const char *flag, *key, *type, *value, *help;
};

constexpr std::array kFlags = {
    ShortFlag{"--camera", "camera_driver.camera_file", "FILE", nullptr,
              "the camera's calibration, ours (see config/cameras) or that of another tool (FILE:cam1: one of its "
              "cameras); without it the one beside the data or in the log"},
    ShortFlag{
        "--mask", "camera_driver.mask", "PNG", nullptr,
        "what of the images does not show the world (a bonnet, a caption) is black in this file, or in a folder's "
        "file for each image; none: not even the mask beside the data (docs/recordings.md)"},
    ShortFlag{"--every", "camera_driver.every", "N", "1", "every Nth image only"},
    ShortFlag{"--start", "camera_driver.start", "S", "0", "leave out S seconds at the beginning"},
    ShortFlag{"--duration", "camera_driver.duration", "S", "0", "end after S seconds; 0: with the recording"},
    ShortFlag{"--rate", "camera_driver.rate", "HZ", "0",
              "recording: new times at this rate, which images without times need (0: as recorded); camera: the rate "
              "to ask for (0: fps of the calibration, else 30)"},
    ShortFlag{"--encoding", "camera_driver.encoding", "FORM", "auto",
              "auto (JPEG files as they are, all else grey), grey, rgb or jpeg"},
    ShortFlag{"--log-channel", "camera_driver.log_channel", "NAME", "CAMERA",
              "channel of the images in an lcm log, or topic in a ROS bag (default there: the one that has images)"},
    ShortFlag{"--loop", "camera_driver.loop", nullptr, nullptr, "begin again at the end, for ever; times keep rising"},
    ShortFlag{"--speed", "camera_driver.speed", "N", "1", "N times faster than the times say"},
    ShortFlag{"--live-stamps", "camera_driver.live_stamps", nullptr, nullptr,
              "the time of an image is when it is published"},
};

}  // namespace

void add_flags(CommandLine& command, const std::vector<std::string>& flags, std::vector<std::string>* settings) {
  for (const ShortFlag& flag : kFlags) {
    if (!flags.empty() && std::find(flags.begin(), flags.end(), flag.flag) == flags.end()) continue;
    const std::function<void(const std::string&)> take = [flag, settings](const std::string& value) {
      settings->push_back(by_flag(flag.flag, flag.key, value));
    };
    if (!flag.type) {
      command.add_flag(
          flag.flag, [take] { take("true"); }, flag.help);
      continue;
    }
    Flag option = command.add_option(flag.flag, take, flag.help);
    option.type_name(flag.type);
    if (flag.value) option.shown_default(flag.value);
  }
}

}  // namespace rumi::camera_driver
