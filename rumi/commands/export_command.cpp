// SPDX-License-Identifier: BSD-3-Clause
// rumi export, rumi import: convert recordings to and from the formats of other programs.
#include <memory>
#include <type_traits>
#include <vector>

#include "base/running/log.h"
#include "camera_driver/flags.h"
#include "rumi/commands/command_frame.h"
#include "rumi/commands/commands.h"
#include "rumi/commands/recording_options.h"
#include "rumi/recordings/export_recording.h"
#include "rumi/recordings/import_log.h"
#include "rumi/run/stop_signals.h"

namespace rumi::tool {
namespace {

template <class Options>
struct Arguments {
  Options options;
  std::vector<std::string> settings;
};

template <class Options, int (*work)(const Options&)>
int run(Arguments<Options>& arguments) {
  load_recording_options(arguments.settings, &arguments.options.camera);
  start_logging("rumi", false, false);
  if constexpr (std::is_same_v<Options, ExportOptions>) arguments.options.stop = &listen_to_stop_signals();
  return work(arguments.options);
}

}  // namespace

void add_export_command(CommandLine& app, std::function<int()>* chosen) {
  auto arguments = std::make_shared<Arguments<ExportOptions>>();
  ExportOptions& options = arguments->options;
  CommandLine* command = app.add_command("export", "Write a recording for other programs: as an lcm log or a ROS bag");
  command->add_option("INPUT", options.input, "dataset folder, folder of images, video, lcm log or ROS bag")
      ->required();
  command
      ->add_option("-o,--output", options.file,
                   "NAME.mcap (ROS 2, Foxglove) and NAME.bag (ROS 1) are bags, all else is an lcm log; must not exist")
      ->type_name("FILE")
      .required();
  command
      ->add_option("-c,--channel", options.channel,
                   "channel or topic of the images in what is written (CAMERA; in a bag /camera/image_raw)")
      ->type_name("NAME");
  command
      ->add_option("--poses", options.poses,
                   "poses that are written into the bag, too: the output folder of a run of this recording, or a file "
                   "as of TUM (trajectory.txt)")
      ->type_name("OUT");
  add_recording_settings(command, &arguments->settings);
  camera_driver::add_flags(
      *command, {"--camera", "--mask", "--every", "--start", "--duration", "--log-channel", "--rate", "--encoding"},
      &arguments->settings);
  run_if_chosen(command, chosen, arguments, run<ExportOptions, run_export>);
}

void add_import_command(CommandLine& app, std::function<int()>* chosen) {
  auto arguments = std::make_shared<Arguments<ImportOptions>>();
  ImportOptions& options = arguments->options;
  CommandLine* command = app.add_command("import", "Write the images of an lcm log or ROS bag as a TUM-style folder");
  command->add_option("LOG", options.log, "lcm log or ROS bag")->required();
  command->add_option("-o,--output", options.folder, "folder; created, or empty")->type_name("FOLDER").required();
  add_recording_settings(command, &arguments->settings);
  camera_driver::add_flags(*command, {"--camera", "--every", "--start", "--duration", "--log-channel"},
                           &arguments->settings);
  run_if_chosen(command, chosen, arguments, run<ImportOptions, run_import>);
}

}  // namespace rumi::tool
