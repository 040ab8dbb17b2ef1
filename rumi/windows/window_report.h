// SPDX-License-Identifier: BSD-3-Clause
// The outcome of rebuilding a window, as a row of a table, a line of windows.csv, or JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "formats/truth/trajectory.h"
#include "ruminator/rebuild/back_submap_builder.h"

namespace rumi::tool {

struct WindowRow {
  std::string name;  // name of its file without .window
  ruminator::RuminationWindow window;
  ruminator::BuildResult result;  // without the submap, which is replaced by an empty one
  bool ok = false;
  // Number of registered frames that are also keyframes of the submap before the window, and of the one after it.
  int shared_before = 0, shared_after = 0;
  int landmarks = 0;
  std::optional<double> ate_m;   // of the registered frames, after Sim(3) alignment to the truth
  std::optional<double> path_m;  // length of the true path through all frames of the window
};

WindowRow make_window_row(const std::string& name, const ruminator::RuminationWindow& window,
                          const ruminator::BuildResult& result, const std::vector<TimedPose>& truth = {});

nlohmann::ordered_json to_json(const WindowRow& row);
// Columns are separated by commas, in the order of the header. Unknown values are empty.
std::string window_csv_header();
std::string window_csv_line(const WindowRow& row);
// As a table for a terminal.
std::string window_table_header(bool with_truth);
std::string window_table_line(const WindowRow& row, bool with_truth);

}  // namespace rumi::tool
