// SPDX-License-Identifier: BSD-3-Clause
// The program `rumi`: registers all commands and runs the one that the user calls.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>

#include "base/this_process/exit_codes.h"
#include "rumi/about/about.h"
#include "rumi/commands/command_frame.h"
#include "rumi/commands/commands.h"
#include "rumi/commands/programs.h"

namespace {

using namespace rumi::tool;

// In the order in which --help lists them.
constexpr std::array kCommands = {
    add_demo_command,       add_replay_command,     add_up_command,         add_snapshot_command,
    add_status_command,     add_web_command,        add_ruminate_command,   add_evaluate_command,
    add_report_command,     add_view_command,       add_cut_window_command, add_draw_window_command,
    add_export_map_command, add_draw_board_command, add_calibrate_command,  add_synth_command,
    add_export_command,     add_mask_command,       add_import_command,     add_config_command};

}  // namespace

int main(int argc, char** argv) {
  if (const rumi::Result<> became = rumi::tool::become_program(argv); !became) {
    fmt::print(stderr, "rumi: {}\n", became.error().text());
    return rumi::kNotDone;
  }
  rumi::CommandLine app("Visual SLAM with one camera, made of small LCM processes.", "rumi");
  app.set_version(rumi::tool::about());
  std::function<int()> chosen;
  for (const auto add_command : kCommands) add_command(app, &chosen);
  for (const char* program : rumi::tool::kPrograms) app.add_other_command(program);
  // The footer is set after the commands are added, because they would inherit it.
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
