// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/windows/window_report.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/text/json_text.h"
#include "rumi/evaluation/metrics.h"

namespace rumi::tool {
namespace {

using nlohmann::ordered_json;

std::vector<TimedPose> trajectory_of(const Submap& submap) {
  std::vector<TimedPose> poses;
  for (const auto& [utime_us, frame] : submap.frames)
    poses.push_back({utime_us, submap.cam_from_submap(frame).inverse()});
  return poses;
}

std::optional<double> path_length(const ruminator::RuminationWindow& window, const std::vector<TimedPose>& truth) {
  std::vector<TimedPose> samples;
  for (const ruminator::Sample& sample : window.samples()) samples.push_back({sample.utime_us, {}});
  const auto pairs = associate(samples, truth);
  if (pairs.size() < 2) return std::nullopt;
  double length = 0;
  for (size_t i = 1; i < pairs.size(); ++i) {
    const SE3 &from = truth[pairs[i - 1].second].map_from_cam, &to = truth[pairs[i].second].map_from_cam;
    length += (to.translation - from.translation).norm();
  }
  return length;
}

int shared(const std::vector<ruminator::Sample>& samples, int32_t submap_id, const Submap& submap) {
  return static_cast<int>(std::count_if(samples.begin(), samples.end(), [&](const ruminator::Sample& s) {
    return s.is_keyframe && s.submap_id == submap_id && submap.frame(s.utime_us);
  }));
}

template <class T>
ordered_json or_null(const std::optional<T>& value) {
  return value ? ordered_json(*value) : ordered_json();
}

std::optional<double> ate_percent(const WindowRow& row) {
  if (!row.ate_m || !row.path_m || *row.path_m <= 0) return std::nullopt;
  return 100 * *row.ate_m / *row.path_m;
}

std::string csv_field(const ordered_json& value) {
  if (value.is_null()) return "";
  if (!value.is_string()) return json_text(value);
  std::string text = value.get<std::string>();
  for (size_t i = 0; (i = text.find('"', i)) != std::string::npos; i += 2) text.insert(i, 1, '"');
  return fmt::format("\"{}\"", text);
}

}  // namespace

WindowRow make_window_row(const std::string& name, const ruminator::RuminationWindow& window,
                          const ruminator::BuildResult& result, const std::vector<TimedPose>& truth) {
  WindowRow row;
  row.name = name;
  row.window = window;
  row.result = result;
  row.ok = result.submap.has_value();
  if (row.ok) row.result.submap = Submap();
  if (!truth.empty()) row.path_m = path_length(window, truth);
  if (!row.ok) return row;
  const Submap& submap = *result.submap;
  row.landmarks = static_cast<int>(submap.landmarks.size());
  row.shared_before = shared(window.approach, window.submap_before, submap);
  row.shared_after = shared(window.departure, window.submap_after, submap);
  if (!truth.empty()) row.ate_m = evaluate_trajectory(trajectory_of(submap), truth).ate_rmse_m;
  return row;
}

// The times come last, because only they differ from run to run.
ordered_json to_json(const WindowRow& row) {
  const ruminator::RuminationWindow& w = row.window;
  const ruminator::BuildResult& r = row.result;
  return {
      {"window", row.name},
      {"session", w.session},
      {"id", w.id},
      {"built", row.ok},
      {"failure", row.ok ? "" : r.submap.error_text()},
      {"submap_before", w.submap_before},
      {"submap_after", w.submap_after},
      {"lost_utime", w.lost_utime_us},
      {"resumed_utime", w.resumed_utime_us},
      {"approach", w.approach.size()},
      {"gap", w.gap.size()},
      {"departure", w.departure.size()},
      {"registered_approach", r.approach},
      {"registered_gap", r.gap},
      {"registered_departure", r.departure},
      {"shared_before", row.shared_before},
      {"shared_after", row.shared_after},
      {"landmarks", row.landmarks},
      {"error_px", r.error_px},
      {"mapper_runs", r.models_tried},
      {"origin", r.origin},
      {"warning", r.warning},
      {"ate_m", or_null(row.ate_m)},
      {"path_m", or_null(row.path_m)},
      {"ate_percent", or_null(ate_percent(row))},
      {"wall_s", r.wall_s},
      {"cpu_s", r.cpu_s},
  };
}

std::string window_csv_header() {
  const ordered_json empty = to_json(WindowRow());
  std::string line;
  for (const auto& [key, value] : empty.items()) line += (line.empty() ? "" : ",") + key;
  return line;
}

std::string window_csv_line(const WindowRow& row) {
  const ordered_json json = to_json(row);
  std::string line;
  for (const auto& [key, value] : json.items()) line += (key == "window" ? "" : ",") + csv_field(value);
  return line;
}

std::string window_table_header(bool with_truth) {
  return fmt::format("{:<24} {:>9} {:>9} {:>9} {:>7} {:>9} {:>8} {:>8}{}", "window", "S1", "S2", "S3", "shared",
                     "error", "wall", "CPU", with_truth ? "       ATE  of path" : "");
}

std::string window_table_line(const WindowRow& row, bool with_truth) {
  const ruminator::RuminationWindow& w = row.window;
  const ruminator::BuildResult& r = row.result;
  const auto of = [](int registered, size_t all) { return fmt::format("{}/{}", registered, all); };
  std::string line =
      fmt::format("{:<24} {:>9} {:>9} {:>9} {:>7} {:>9} {:>8} {:>8}", row.name, of(r.approach, w.approach.size()),
                  of(r.gap, w.gap.size()), of(r.departure, w.departure.size()),
                  fmt::format("{}+{}", row.shared_before, row.shared_after), fmt::format("{:.2f} px", r.error_px),
                  fmt::format("{:.1f} s", r.wall_s), fmt::format("{:.1f} s", r.cpu_s));
  if (with_truth) {
    const std::optional<double> percent = ate_percent(row);
    line += fmt::format(" {:>9} {:>8}", row.ate_m ? fmt::format("{:.4f} m", *row.ate_m) : "-",
                        percent ? fmt::format("{:.2f} %", *percent) : "-");
  }
  return row.ok ? line : fmt::format("{}\n    failed: {}", line, r.submap.error_text());
}

}  // namespace rumi::tool
