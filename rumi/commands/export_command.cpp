// SPDX-License-Identifier: BSD-3-Clause
// rumi export and rumi import: recordings to and from lcm logs.
#include <fmt/format.h>

#include <memory>
#include <vector>

#include "base/command_line.h"
#include "base/log.h"
#include "base/options.h"
#include "camera_driver/options.h"
#include "rumi/commands/commands.h"
#include "rumi/recordings/export_log.h"
#include "rumi/recordings/import_log.h"

namespace rumi::tool {
namespace {

template <class Options>
int run(const char* name, int (*work)(const Options&), Options options, const std::vector<std::string>& settings) {
  OptionTable table;
  describe(table, options.camera);
  if (const std::string error = load_options(table, "", settings); !error.empty()) {
    fmt::print(stderr, "rumi {}: {}\n", name, error);
    return 2;
  }
  start_logging("rumi", false, false);
  return work(options);
}

void add_camera_flags(CommandLine& command, camera_driver::CameraOptions& camera, std::vector<std::string>& settings) {
  command.add_option("--set", settings, "camera_driver.KEY=VALUE, may be repeated")->one_each();
  command
      .add_option("--camera", camera.camera_file,
                  "calibration file (FILE:cam1: one of its cameras), instead of the one beside the data or in the log")
      ->type_name("FILE");
  command.add_option("--every", camera.every, "every Nth image only")->show_default();
  command.add_option("--start", camera.start_s, "leave out so many seconds at the beginning")->show_default();
  command.add_option("--duration", camera.duration_s, "end after so many seconds, 0: all")->show_default();
  command.add_option("--log-channel", camera.log_channel, "channel of the images where the input is an lcm log")
      ->show_default();
}

}  // namespace

void add_export_command(CommandLine& app, std::function<int()>* chosen) {
  auto options = std::make_shared<ExportOptions>();
  auto settings = std::make_shared<std::vector<std::string>>();
  CommandLine* command = app.add_command("export", "Write a recording as an lcm log, for lcm-logplayer and others");
  command->add_option("INPUT", options->input, "dataset folder, image folder, video or lcm log")->required();
  command->add_option("-o,--output", options->log, "the log; must not exist")->required();
  command->add_option("-c,--channel", options->channel, "channel of the images")->show_default();
  add_camera_flags(*command, options->camera, *settings);
  command->add_option("--rate", options->camera.rate_hz, "new times at this rate, Hz; 0: as recorded")->show_default();
  command
      ->add_option("--encoding", options->camera.encoding,
                   "auto (JPEG files as they are, all else grey), grey, rgb, jpeg")
      ->show_default();
  command->on_chosen([options, settings, chosen] {
    *chosen = [options, settings] { return run("export", run_export, *options, *settings); };
  });
}

void add_import_command(CommandLine& app, std::function<int()>* chosen) {
  auto options = std::make_shared<ImportOptions>();
  auto settings = std::make_shared<std::vector<std::string>>();
  CommandLine* command = app.add_command("import", "Write the images of an lcm log as a TUM-style folder");
  command->add_option("LOG", options->log, "lcm log")->required();
  command->add_option("-o,--output", options->folder, "folder; created, or empty")->required();
  add_camera_flags(*command, options->camera, *settings);
  command->on_chosen([options, settings, chosen] {
    *chosen = [options, settings] { return run("import", run_import, *options, *settings); };
  });
}

}  // namespace rumi::tool
