// SPDX-License-Identifier: BSD-3-Clause
// What came of rebuilding a window, as a row of a table, of windows.csv, or as JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "formats/truth/trajectory.h"
#include "ruminator/rebuild/back_submap_builder.h"

namespace rumi::tool {

struct WindowRow {
  std::string name;  // of its file, without .window
  ruminator::RuminationWindow window;
  ruminator::BuildResult result;  // its submap is empty
  bool ok = false;
  // Of the registered frames, how many are keyframes of the submap before and of that after.
  int shared_before = 0, shared_after = 0;
  int landmarks = 0;
  // Of the registered frames against the truth, after Sim(3) alignment.
  std::optional<double> ate_m;
  std::optional<double> path_m;  // of the truth, through all frames of the window
};

WindowRow make_window_row(const std::string& name, const ruminator::RuminationWindow& window,
                          const ruminator::BuildResult& result, const std::vector<TimedPose>& truth = {});

nlohmann::ordered_json to_json(const WindowRow& row);
// Columns separated by commas, as `header` names them. What is not known is empty.
std::string window_csv_header();
std::string window_csv_line(const WindowRow& row);
// For a terminal.
std::string window_table_header(bool with_truth);
std::string window_table_line(const WindowRow& row, bool with_truth);

}  // namespace rumi::tool
