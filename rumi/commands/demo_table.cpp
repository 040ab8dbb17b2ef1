// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/commands/demo_table.h"

#include <fmt/format.h>

#include <optional>

namespace rumi::tool {
namespace {

std::string metres(const std::optional<double>& value) { return value ? fmt::format("{:.3f} m", *value) : "unknown"; }

std::string percent(const std::optional<double>& ratio) {
  return ratio ? fmt::format("{:.1f} %", 100 * *ratio) : "unknown";
}

std::string row(const std::string& what, const std::string& front, const std::string& whole) {
  return fmt::format("{:<52}{:>14}{:>14}\n", what, front, whole);
}

// Returns "2 images" or "1 image".
std::string count_of(int64_t n, const char* what) { return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s"); }

std::string tell(const WindowRow& row, int64_t begin_us) {
  const ruminator::RuminationWindow& window = row.window;
  const auto seconds = [](int64_t us) { return static_cast<double>(us) * 1e-6; };
  std::string text = fmt::format("Tracking was lost at {:.1f} s for {:.1f} s", seconds(window.lost_utime_us - begin_us),
                                 seconds(window.resumed_utime_us - window.lost_utime_us));
  const ruminator::BuildResult& result = row.result;
  if (!row.ok) return text + fmt::format("; what was lost could not be rebuilt: {}.\n", result.submap.error_text());
  return text + fmt::format("; of {} that were kept of it COLMAP rebuilt {} in {:.1f} s.\n",
                            count_of(static_cast<int64_t>(window.gap.size()), "image"), result.gap, result.wall_s);
}

}  // namespace

std::string demo_table(const MeasuredRun& front, const MeasuredRun& whole) {
  const RunMetrics &a = front.evaluation.run, &b = whole.evaluation.run;
  const auto of_all = [](const RunMetrics& run) { return fmt::format("{} of {}", run.tracked_frames, run.frames); };
  const auto seconds = [](const MeasuredRun& run) { return fmt::format("{:.1f} s", run.outcome.wall_s); };
  return row("", "front alone", "Rumi") + row("frames with a pose in the one map", of_all(a), of_all(b)) +
         row("length of the true path that they cover", metres(a.map.path_m), metres(b.map.path_m)) +
         row("error of these poses (ATE, RMSE)", metres(a.map.ate_rmse_m), metres(b.map.ate_rmse_m)) +
         row("frames within 0.10 m of the truth, of all frames", percent(a.true_rate), percent(b.true_rate)) +
         row("time it took", seconds(front), seconds(whole));
}

std::string demo_story(const ReplayOutcome& whole) {
  if (whole.windows.empty()) return "Tracking was never lost for good: there was nothing to rebuild.\n";
  std::string text;
  for (const WindowRow& row : whole.windows) text += tell(row, whole.begin_us);
  const AtlasCounts& counts = whole.counts;
  if (counts.front_submaps_in_map == counts.front_submaps)
    return text + fmt::format("{} of the front became one map.\n", count_of(counts.front_submaps, "submap"));
  return text + fmt::format("Of {} of the front the one map has {}.\n", count_of(counts.front_submaps, "submap"),
                            counts.front_submaps_in_map);
}

}  // namespace rumi::tool
