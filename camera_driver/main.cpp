// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <optional>

#include "base/command_line.h"
#include "camera_driver/camera_node.h"
#include "camera_driver/options.h"
#include "camera_driver/v4l2/video_device.h"

namespace {

// Kept apart from the options until these are loaded from --config: what is on the command line wins.
struct Flags {
  std::string input;
  std::optional<std::string> camera_file, encoding;
  std::optional<int> every;
  std::optional<double> start_s, duration_s, rate_hz, speed;
  bool loop = false, live_stamps = false;

  void apply(rumi::camera_driver::CameraOptions* o) const {
    o->camera_file = camera_file.value_or(o->camera_file);
    o->encoding = encoding.value_or(o->encoding);
    o->every = every.value_or(o->every);
    o->start_s = start_s.value_or(o->start_s);
    o->duration_s = duration_s.value_or(o->duration_s);
    o->rate_hz = rate_hz.value_or(o->rate_hz);
    o->speed = speed.value_or(o->speed);
    o->loop |= loop;
    o->live_stamps |= live_stamps;
  }
};

void add_flags(rumi::CommandLine& app, Flags* flags) {
  app.add_option(
         "INPUT", flags->input,
         "what to publish: a camera (/dev/video0, a name in /dev/v4l/by-id, or camera:NAME), a TUM-style folder (with "
         "rgb.txt), an EuRoC folder (with mav0/cam0), a folder of images, a video, or an lcm log")
      ->required();
  app.add_action(
      "--list", [] { fmt::print("{}", rumi::camera_driver::list_cameras(rumi::camera_driver::kernel_video_system())); },
      "show the cameras with their formats, sizes, rates and controls, and end");
  app.add_option(
         "--camera", flags->camera_file,
         "the camera's calibration: our YAML (see config/cameras) or that of ROS, Kalibr, OpenCV, EuRoC or "
         "ORB-SLAM; without it calibration.yaml beside the data, or what the log says. A camera's image size is that "
         "of its calibration")
      ->type_name("FILE");
  app.add_option("--every", flags->every, "publish every Nth image (1)")->type_name("N");
  app.add_option("--start", flags->start_s, "leave out S seconds at the beginning (0)")->type_name("S");
  app.add_option("--duration", flags->duration_s, "end after S seconds (0: all of the recording; never with a camera)")
      ->type_name("S");
  app.add_flag("--loop", flags->loop, "begin again at the end, for ever; times keep rising");
  app.add_option("--rate", flags->rate_hz,
                 "recording: new times and pace at this rate (0: as recorded); camera: the rate to ask for "
                 "(0: fps of the calibration, else 30)")
      ->type_name("HZ");
  app.add_option("--speed", flags->speed, "N times faster than the times say (1)")->type_name("N");
  app.add_flag("--live-stamps", flags->live_stamps, "the time of an image is when it is published");
  app.add_option("--encoding", flags->encoding, "auto (JPEG as it is, all else grey), grey, rgb or jpeg (auto)")
      ->type_name("FORM");
}

}  // namespace

int main(int argc, char** argv) {
  Flags flags;
  rumi::camera_driver::CameraOptions options;
  rumi::ProcessDescription process;
  process.name = "camera_driver";
  process.only_one_on_channel = true;
  process.summary =
      "Publishes the images of a camera (V4L2), or of a recording at the pace at which they were recorded, on CAMERA. "
      "SIGUSR2: reads --config again and sets the camera's controls.";
  process.add_flags = [&flags](rumi::CommandLine& app) { add_flags(app, &flags); };
  process.add_options = [&options](rumi::OptionTable& table) { describe(table, options); };
  process.make_node = [&](rumi::Bus& bus) {
    flags.apply(&options);
    return std::make_unique<rumi::camera_driver::CameraNode>(bus, flags.input, options);
  };
  process.on_reload = [&](rumi::Node& node) {
    flags.apply(&options);
    const std::string problem = check(options);
    if (problem.empty()) static_cast<rumi::camera_driver::CameraNode&>(node).set_controls(options);
    return problem;
  };
  return rumi::run_process(argc, argv, process);
}
