// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <optional>

#include "camera_driver/camera_node.h"

namespace {

// Kept apart from the options until these are loaded from --config: what is on the command line wins.
struct Flags {
  std::string input;
  std::optional<std::string> camera_file, encoding;
  std::optional<int> every;
  std::optional<double> start_s, duration_s, rate_hz, speed;
  bool loop = false, live_stamps = false;

  void apply(rumi::CameraOptions* o) const {
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

void add_flags(CLI::App& app, Flags* flags) {
  app.add_option(
         "INPUT", flags->input,
         "what to publish: a TUM-style folder (with rgb.txt), an EuRoC folder (with mav0/cam0), a folder of images, "
         "a video, or an lcm log. Cameras (/dev/video0) are not supported in this version")
      ->required();
  app.add_option("--camera", flags->camera_file,
                 "the camera's calibration: our YAML (see config/cameras) or that of ROS, Kalibr, OpenCV, EuRoC or "
                 "ORB-SLAM; without it calibration.yaml beside the data, or what the log says")
      ->type_name("FILE");
  app.add_option("--every", flags->every, "publish every Nth image (1)")->type_name("N");
  app.add_option("--start", flags->start_s, "leave out S seconds at the beginning (0)")->type_name("S");
  app.add_option("--duration", flags->duration_s, "end after S seconds of the recording (0: all)")->type_name("S");
  app.add_flag("--loop", flags->loop, "begin again at the end, for ever; times keep rising");
  app.add_option("--rate", flags->rate_hz, "new times and pace at this rate (0: as recorded)")->type_name("HZ");
  app.add_option("--speed", flags->speed, "N times faster than the times say (1)")->type_name("N");
  app.add_flag("--live-stamps", flags->live_stamps, "the time of an image is when it is published");
  app.add_option("--encoding", flags->encoding,
                 "auto (JPEG files as they are, all else grey), grey, rgb or jpeg (auto)")
      ->type_name("FORM");
}

}  // namespace

int main(int argc, char** argv) {
  Flags flags;
  rumi::CameraOptions options;
  rumi::ProcessDescription process;
  process.name = "camera_driver";
  process.summary = "Publishes recorded images on CAMERA, at the pace at which they were recorded.";
  process.add_flags = [&flags](CLI::App& app) { add_flags(app, &flags); };
  process.add_options = [&options](rumi::OptionTable& table) { describe(table, options); };
  process.make_node = [&](rumi::Bus& bus) {
    flags.apply(&options);
    return std::make_unique<rumi::CameraNode>(bus, flags.input, options);
  };
  return rumi::run_process(argc, argv, process);
}
