// SPDX-License-Identifier: BSD-3-Clause
// rumi cut-window INPUT -o FILE: writes chosen frames of a recording as a window that `rumi ruminate` rebuilds.
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

// Returns the chosen ranges of frames. Throws WrongOptions.
WindowCut parse(const Arguments& arguments) {
  const auto optional = [](const std::string& text) -> std::optional<FrameRange> {
    if (text.empty()) return std::nullopt;
    return value_or_refuse(parse_frame_range(text));
  };
  const FrameRange gap = value_or_refuse(parse_frame_range(arguments.gap));
  const WindowCut cut{optional(arguments.approach), gap, optional(arguments.departure)};
  refuse_if(cut.check());
  return cut;
}

void cut_window(const Arguments& arguments) {
  const WindowCut cut = parse(arguments);
  refuse_if(check(arguments.camera));
  start_logging("rumi", false, arguments.quiet);
  const auto source = value_or_fail(camera_driver::open_recording(arguments.input, arguments.camera));
  const ruminator::WindowJob job = value_or_fail(cut_window(*source, cut));
  fail_if(ruminator::write_window_job(arguments.file, job));
  const ruminator::RuminationWindow& w = job.window;
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
