// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <string>
#include <vector>

#include "base/command_line/about.h"
#include "base/command_line/command_line.h"
#include "camera_driver/camera_node.h"
#include "camera_driver/flags.h"
#include "camera_driver/options.h"
#include "camera_driver/v4l2/video_device.h"

namespace {

void add_own_flags(rumi::CommandLine& app, std::string* input, std::vector<std::string>* settings) {
  app.add_option(
         "INPUT", *input,
         "what to publish: a camera (/dev/video0, a name in /dev/v4l/by-id, or camera:NAME), a TUM-style folder (with "
         "rgb.txt), an EuRoC folder (with mav0/cam0), a folder of images, a video, an lcm log, or a ROS bag")
      ->required();
  app.add_action(
      "--list", [] { fmt::print("{}", rumi::camera_driver::list_cameras(rumi::camera_driver::kernel_video_system())); },
      "show the cameras with their formats, sizes, rates and controls, and end");
  rumi::camera_driver::add_flags(app, {}, settings);
}

}  // namespace

int main(int argc, char** argv) {
  std::string input;
  rumi::camera_driver::CameraOptions options;
  rumi::ProcessDescription process;
  process.name = "camera_driver";
  process.about = rumi::about(process.name);
  process.only_one_on_channel = true;
  process.summary =
      "Publishes the images of a camera (V4L2), or of a recording at the pace at which they were recorded, on CAMERA. "
      "SIGUSR2: reads --config again and sets the camera's controls.";
  process.add_flags = [&input](rumi::CommandLine& app, std::vector<std::string>* settings) {
    add_own_flags(app, &input, settings);
  };
  process.add_options = [&options](rumi::OptionTable& table) { describe(table, options); };
  process.check_options = [&options] { return check(options).error_text(); };
  process.make_node = [&](rumi::Bus& bus) {
    return std::make_unique<rumi::camera_driver::CameraNode>(bus, input, options);
  };
  process.on_reload = [&](rumi::Node& node) {
    static_cast<rumi::camera_driver::CameraNode&>(node).set_controls(options);
  };
  return rumi::run_process(argc, argv, process);
}
