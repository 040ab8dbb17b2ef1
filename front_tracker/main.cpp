// SPDX-License-Identifier: BSD-3-Clause
#include "base/command_line/about.h"
#include "base/command_line/command_line.h"
#include "bus/process/process.h"
#include "formats/camera/given_camera.h"
#include "front_tracker/front_tracker_node.h"

int main(int argc, char** argv) {
  rumi::front_tracker::FrontTrackerOptions options;
  rumi::ProcessDescription process;
  process.name = "front_tracker";
  process.about = rumi::about(process.name);
  process.only_one = true;
  process.summary =
      "Tracks the camera in real time: images come in on CAMERA, a state and a pose for each go out on RUMI_TRACK, the "
      "submaps on RUMI_SUBMAP.";
  process.add_flags = [&options](rumi::CommandLine& app, std::vector<std::string>*) {
    app.add_option("--camera", options.camera_file,
                   "calibration file (FILE:cam1: one of its cameras), instead of the one that comes with the images")
        ->type_name("FILE");
  };
  process.add_options = [&options](rumi::OptionTable& table) { describe(table, options); };
  process.make_node = [&options](rumi::Bus& bus) {
    return std::make_unique<rumi::front_tracker::FrontTrackerNode>(bus, options,
                                                                   rumi::read_given_camera(options.camera_file));
  };
  return rumi::run_process(argc, argv, process);
}
