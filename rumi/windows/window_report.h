// SPDX-License-Identifier: BSD-3-Clause
// The outcome of rebuilding a window, as a row of a table, of windows.csv, or as JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "formats/truth/trajectory.h"
#include "ruminator/rebuild/back_submap_builder.h"

namespace rumi::tool {

struct WindowRow {
  std::string name;  // its file's name without .window
  ruminator::RuminationWindow window;
  ruminator::BuildResult result;  // its submap is empty
  bool ok = false;
  // How many registered frames are keyframes of the submap before the window, and of the one after it.
  int shared_before = 0, shared_after = 0;
  int landmarks = 0;
  std::optional<double> ate_m;   // of the registered frames, after Sim(3) alignment with the truth
  std::optional<double> path_m;  // length of the true path through all frames of the window
};

WindowRow make_window_row(const std::string& name, const ruminator::RuminationWindow& window,
                          const ruminator::BuildResult& result, const std::vector<TimedPose>& truth = {});

nlohmann::ordered_json to_json(const WindowRow& row);
// Columns separated by commas, in the order of the header; unknown values are empty.
std::string window_csv_header();
std::string window_csv_line(const WindowRow& row);
// For a terminal.
std::string window_table_header(bool with_truth);
std::string window_table_line(const WindowRow& row, bool with_truth);

}  // namespace rumi::tool
