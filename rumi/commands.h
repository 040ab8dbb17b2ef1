// SPDX-License-Identifier: BSD-3-Clause
// The subcommands of `rumi`. Each function registers one; when the user calls it, *chosen becomes what is to be run,
// and its result is the exit code: 0, 1 for a failure, 2 for a wrong command line.
#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace rumi {

void add_demo_command(CLI::App& app, std::function<int()>* chosen);
void add_up_command(CLI::App& app, std::function<int()>* chosen);
void add_replay_command(CLI::App& app, std::function<int()>* chosen);
void add_ruminate_command(CLI::App& app, std::function<int()>* chosen);
void add_evaluate_command(CLI::App& app, std::function<int()>* chosen);
void add_report_command(CLI::App& app, std::function<int()>* chosen);
void add_snapshot_command(CLI::App& app, std::function<int()>* chosen);
void add_status_command(CLI::App& app, std::function<int()>* chosen);
void add_view_command(CLI::App& app, std::function<int()>* chosen);
void add_cut_window_command(CLI::App& app, std::function<int()>* chosen);
void add_draw_window_command(CLI::App& app, std::function<int()>* chosen);
void add_export_map_command(CLI::App& app, std::function<int()>* chosen);
void add_draw_board_command(CLI::App& app, std::function<int()>* chosen);
void add_calibrate_command(CLI::App& app, std::function<int()>* chosen);
void add_synth_command(CLI::App& app, std::function<int()>* chosen);
void add_export_command(CLI::App& app, std::function<int()>* chosen);
void add_import_command(CLI::App& app, std::function<int()>* chosen);
void add_config_command(CLI::App& app, std::function<int()>* chosen);

}  // namespace rumi
