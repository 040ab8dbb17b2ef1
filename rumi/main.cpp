// SPDX-License-Identifier: BSD-3-Clause
// `rumi`: the one command of the user.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/this_process/exit_codes.h"
#include "rumi/about/about.h"
#include "rumi/commands/command_frame.h"
#include "rumi/commands/commands.h"
#include "rumi/commands/programs.h"

int main(int argc, char** argv) {
  if (const std::string problem = rumi::tool::become_program(argv); !problem.empty()) {
    fmt::print(stderr, "rumi: {}\n", problem);
    return rumi::kNotDone;
  }
  rumi::CommandLine app("Visual SLAM with one camera, made of small LCM processes.", "rumi");
  app.set_version(rumi::tool::about());
  std::function<int()> chosen;
  rumi::tool::add_demo_command(app, &chosen);
  rumi::tool::add_replay_command(app, &chosen);
  rumi::tool::add_up_command(app, &chosen);
  rumi::tool::add_snapshot_command(app, &chosen);
  rumi::tool::add_status_command(app, &chosen);
  rumi::tool::add_web_command(app, &chosen);
  rumi::tool::add_ruminate_command(app, &chosen);
  rumi::tool::add_evaluate_command(app, &chosen);
  rumi::tool::add_report_command(app, &chosen);
  rumi::tool::add_view_command(app, &chosen);
  rumi::tool::add_cut_window_command(app, &chosen);
  rumi::tool::add_draw_window_command(app, &chosen);
  rumi::tool::add_export_map_command(app, &chosen);
  rumi::tool::add_draw_board_command(app, &chosen);
  rumi::tool::add_calibrate_command(app, &chosen);
  rumi::tool::add_synth_command(app, &chosen);
  rumi::tool::add_export_command(app, &chosen);
  rumi::tool::add_mask_command(app, &chosen);
  rumi::tool::add_import_command(app, &chosen);
  rumi::tool::add_config_command(app, &chosen);
  for (const char* program : rumi::tool::kPrograms) app.add_other_command(program);
  // Behind the commands, which would take it over.
  app.footer(fmt::format(
      "`rumi {} ...` runs one of the processes that `rumi up` starts.\n`rumi COMMAND --help` explains a "
      "command. Exit codes: 0 done; 1 not done, with what is wrong and what to do; 2 wrong options; 3 done, "
      "but not with all of the recording.",
      fmt::join(rumi::tool::kPrograms, "|")));
  return rumi::tool::run_command(argc > 1 ? argv[1] : "", [&] {
    const rumi::CommandLine::Result parsed = app.parse(argc, argv);
    if (parsed.done) return rumi::kDone;
    if (!parsed.error.empty()) {
      const std::string command = argc > 1 && app.has_command(argv[1]) ? std::string(" ") + argv[1] : "";
      fmt::print(stderr, "rumi{0}: {1}\nTry `rumi{0} --help`.\n", command, parsed.error);
      return rumi::kNotAgain;
    }
    return chosen();
  });
}
