// SPDX-License-Identifier: BSD-3-Clause
// The subcommands of `rumi`. Each function registers one. If the user calls it, *chosen becomes the function for
// run_command().
#pragma once

#include <functional>

namespace rumi {
class CommandLine;
}

namespace rumi::tool {

void add_demo_command(CommandLine& app, std::function<int()>* chosen);
void add_up_command(CommandLine& app, std::function<int()>* chosen);
void add_replay_command(CommandLine& app, std::function<int()>* chosen);
void add_ruminate_command(CommandLine& app, std::function<int()>* chosen);
void add_evaluate_command(CommandLine& app, std::function<int()>* chosen);
void add_report_command(CommandLine& app, std::function<int()>* chosen);
void add_snapshot_command(CommandLine& app, std::function<int()>* chosen);
void add_status_command(CommandLine& app, std::function<int()>* chosen);
void add_web_command(CommandLine& app, std::function<int()>* chosen);
void add_view_command(CommandLine& app, std::function<int()>* chosen);
void add_cut_window_command(CommandLine& app, std::function<int()>* chosen);
void add_draw_window_command(CommandLine& app, std::function<int()>* chosen);
void add_export_map_command(CommandLine& app, std::function<int()>* chosen);
void add_draw_board_command(CommandLine& app, std::function<int()>* chosen);
void add_calibrate_command(CommandLine& app, std::function<int()>* chosen);
void add_synth_command(CommandLine& app, std::function<int()>* chosen);
void add_export_command(CommandLine& app, std::function<int()>* chosen);
void add_mask_command(CommandLine& app, std::function<int()>* chosen);
void add_import_command(CommandLine& app, std::function<int()>* chosen);
void add_config_command(CommandLine& app, std::function<int()>* chosen);

}  // namespace rumi::tool
