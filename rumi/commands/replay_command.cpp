// SPDX-License-Identifier: BSD-3-Clause
// rumi replay INPUT -o OUT: runs all components on a recording, in this process, and writes the map and the paths.
#include <fmt/format.h>

#include <memory>

#include "base/running/log.h"
#include "base/this_process/exit_codes.h"
#include "bus/process/process.h"
#include "camera_driver/flags.h"
#include "rumi/commands/command_frame.h"
#include "rumi/commands/commands.h"
#include "rumi/commands/progress_line.h"
#include "rumi/commands/replay_run.h"
#include "rumi/outputs/output_folder.h"
#include "rumi/outputs/run_record.h"
#include "rumi/outputs/run_summary.h"
#include "rumi/run/all_options.h"
#include "rumi/run/stop_signals.h"

namespace rumi::tool {
namespace {

struct Arguments : OptionFlags {
  ReplayRun run;
  bool quiet = false, verbose = false;
};

Result<> check(const AllOptions& options, const std::string& out) {
  const map_server::MapServerOptions& map = options.map_server;
  if (out.empty()) return Error{"--output is empty: give a folder"};
  if (const Result<> camera = check(options.camera_driver); !camera) return camera;
  return map.localize_only ? check_map_stays(map.database, out) : Result<>();
}

// Tells a user who named a database that the replay does not go on with its map, as a live system would.
void tell_of_database(const map_server::MapServerOptions& map) {
  if (map.localize_only || map.database == map_server::MapServerOptions().database ||
      map.database == map_server::kInMemory)
    return;
  log_info(
      "map_server.database = {} is not used: a replay begins a map of its own, FOLDER/map.db; with "
      "map_server.localize_only=true it localizes in this one",
      map.database);
}

int replay(Arguments& arguments) {
  ReplayRun& run = arguments.run;
  OptionTable table;
  describe(table, run.options);
  load(table, arguments);
  refuse_if(check(run.options, run.out));
  start_logging("rumi", arguments.verbose, arguments.quiet);
  tell_of_database(run.options.map_server);
  run.options_yaml = table.to_yaml(OptionTable::Which::kAll);
  run.stop = &listen_to_stop_signals();
  ProgressLine line(!arguments.quiet);
  run.on_progress = [&line](const ReplayProgress& progress) {
    line.update(progress.frames, progress.total, [&] {
      return describe_progress(progress.frames, progress.total, line.seconds()) + "; " + progress.state();
    });
  };
  const ReplayOutcome outcome = run_replay(run);
  line.erase();
  if (!outcome.warning.empty()) complain("replay", outcome.warning);
  fail_if(outcome.written);
  if (!arguments.quiet) {
    print_summary(outcome.counts, outcome.notes, outcome.left_out, run.out);
    fmt::print("{} images in {:.1f} s\n", outcome.images, outcome.wall_s);
  }
  if (outcome.stopped)
    complain("replay",
             fmt::format("ended by {} after {}{} images; {} has what there was by then", what_stopped(), outcome.images,
                         outcome.total < 0 ? "" : fmt::format(" of {}", outcome.total), run.out));
  for (const std::string& complaint : outcome.complaints) complain("replay", complaint);
  return outcome.complaints.empty() && !outcome.stopped ? 0 : kNotAll;
}

}  // namespace

void add_replay_command(CommandLine& app, std::function<int()>* chosen) {
  auto arguments = std::make_shared<Arguments>();
  CommandLine* command =
      app.add_command("replay", "Run all components on a recording in one process, as fast as possible, repeatably");
  command->add_option("INPUT", arguments->run.input, "dataset folder, folder of images, video, lcm log or ROS bag")
      ->required();
  command
      ->add_option("-o,--output", arguments->run.out,
                   "folder; one with files that would be overwritten is refused, unless an earlier run made them")
      ->type_name("FOLDER")
      .required();
  command->add_option("--log", arguments->run.log, "lcm log to write: every message on the bus, images included")
      ->type_name("FILE");
  command->add_flag("--colours", arguments->run.colours_of_videos,
                    "map.ply has the colours of the images for a video, too, which is decoded once more for them");
  add_option_flags(command, arguments.get());
  command->add_flag("-q,--quiet", arguments->quiet, "warnings and errors only");
  command->add_flag("-v,--verbose", arguments->verbose, "log more: each window, submap and adjustment on its way");
  camera_driver::add_flags(
      *command, {"--camera", "--mask", "--every", "--start", "--duration", "--rate", "--encoding", "--log-channel"},
      &arguments->settings);
  run_if_chosen(command, chosen, arguments, replay);
}

}  // namespace rumi::tool
