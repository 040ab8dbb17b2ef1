// SPDX-License-Identifier: BSD-3-Clause
// rumi cut-window INPUT -o FILE: chosen frames of a recording as a window that `rumi ruminate` rebuilds.
#include <fmt/format.h>

#include <memory>

#include "base/running/log.h"
#include "bus/process/process.h"
#include "camera_driver/open_source.h"
#include "camera_driver/source/image_source.h"
#include "rumi/commands/command_frame.h"
#include "rumi/commands/commands.h"
#include "rumi/windows/cut_window.h"

namespace rumi::tool {
namespace {

struct Arguments {
  std::string input, file, approach, gap, departure;
  camera_driver::CameraOptions camera;
  bool quiet = false;
};

// What is wrong, or an empty string.
std::string parse(const Arguments& arguments, WindowCut* cut) {
  std::string error = parse_frame_range(arguments.gap, &cut->gap);
  const auto optional = [&error](const std::string& text, std::optional<FrameRange>* range) {
    if (error.empty() && !text.empty()) error = parse_frame_range(text, &range->emplace());
  };
  optional(arguments.approach, &cut->approach);
  optional(arguments.departure, &cut->departure);
  return error.empty() ? cut->check() : error;
}

void cut_window(const Arguments& arguments) {
  WindowCut cut;
  refuse_if(parse(arguments, &cut));
  refuse_if(check(arguments.camera).error_text());
  start_logging("rumi", false, arguments.quiet);
  camera_driver::OpenedSource opened = camera_driver::open_recording(arguments.input, arguments.camera);
  fail_if(opened.error_text());
  const CutWindow window = cut_window(**opened, cut);
  fail_if(window.error);
  fail_if(ruminator::write_window_job(arguments.file, window.job).error_text());
  const ruminator::RuminationWindow& w = window.job.window;
  if (!arguments.quiet)
    fmt::print("{}: {} + {} + {} frames\n", arguments.file, w.approach.size(), w.gap.size(), w.departure.size());
}

}  // namespace

void add_cut_window_command(CommandLine& app, std::function<int()>* chosen) {
  auto arguments = std::make_shared<Arguments>();
  CommandLine* command =
      app.add_command("cut-window", "Make a window of chosen frames of a recording, for `rumi ruminate`");
  command->add_option("INPUT", arguments->input, "dataset folder, folder of images, video, lcm log or ROS bag")
      ->required();
  command->add_option("-o,--output", arguments->file, "the window file, by custom *.window")
      ->type_name("FILE")
      .required();
  const std::string form = "FIRST..LAST[:STRIDE]";
  command->add_option("--gap", arguments->gap, "the frames that shall be rebuilt, counted from 0")
      ->type_name(form)
      ->required();
  command->add_option("--approach", arguments->approach, "frames before the gap")->type_name(form);
  command->add_option("--departure", arguments->departure, "frames after the gap")->type_name(form);
  command
      ->add_option("--camera", arguments->camera.camera_file,
                   "calibration file (FILE:cam1: one of its cameras), instead of the one beside the data")
      ->type_name("FILE");
  command
      ->add_option(
          "--mask", arguments->camera.mask,
          "mask of the images, or a folder with one an image, instead of the one beside the data; none: no mask")
      ->type_name("PNG");
  command->add_option("--start", arguments->camera.start_s, "leave out so many seconds; the next frame is frame 0")
      ->show_default();
  command->add_flag("-q,--quiet", arguments->quiet, "warnings and errors only");
  run_if_chosen(command, chosen, arguments, [](const Arguments& these) { cut_window(these); });
}

}  // namespace rumi::tool
