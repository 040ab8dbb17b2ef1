// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/evaluation/run_evaluation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <utility>

#include "rumi/evaluation/truth_shift.h"
#include "slam/numeric/median.h"

namespace rumi::tool {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

using Submaps = std::map<std::string, std::vector<TimedPose>>;  // by name of the submap's file

template <class T>
ordered_json or_null(const std::optional<T>& value) {
  return value ? ordered_json(*value) : ordered_json();
}

// Returns run.json; an empty object if it cannot be read, as the trajectory can be evaluated without it.
ordered_json read_run(const fs::path& run_json) {
  std::ifstream in(run_json);
  ordered_json run = ordered_json::parse(in, nullptr, /*allow_exceptions=*/false);
  return run.is_object() ? run : ordered_json::object();
}

// Returns the poses of `map` at the times of the poses of `submap`. Both are sorted by time.
std::vector<TimedPose> at_times_of(const std::vector<TimedPose>& submap, const std::vector<TimedPose>& map) {
  std::vector<TimedPose> poses;
  const auto earlier = [](const TimedPose& a, const TimedPose& b) { return a.utime_us < b.utime_us; };
  std::set_intersection(map.begin(), map.end(), submap.begin(), submap.end(), std::back_inserter(poses), earlier);
  return poses;
}

// Returns the poses for which frames.csv has deviations, one list per submap. A frame in the map has its pose and its
// deviations in the map's unit, any other frame in its submap's. Submaps of other sessions are not found, because their
// files have other names.
std::vector<std::vector<ToldPose>> told_poses(const std::vector<InputFrame>& frames, const std::vector<TimedPose>& map,
                                              const Submaps& submaps) {
  std::map<std::pair<int, bool>, std::vector<ToldPose>> told;
  for (const InputFrame& frame : frames) {
    if (!frame.sigmas.are_known()) continue;
    const std::string name = fmt::format("{}{:03}", frame.submap < 0 ? "b" : "", std::abs(int64_t{frame.submap}));
    const auto file = submaps.find(name);
    if (!frame.in_map && file == submaps.end()) continue;
    const std::vector<TimedPose>& poses = frame.in_map ? map : file->second;
    const auto pose = std::lower_bound(poses.begin(), poses.end(), frame.utime_us,
                                       [](const TimedPose& p, int64_t utime_us) { return p.utime_us < utime_us; });
    if (pose == poses.end() || pose->utime_us != frame.utime_us) continue;
    std::vector<ToldPose>& of_submap = told[{frame.submap, frame.in_map}];
    if (of_submap.empty() || of_submap.back().pose.utime_us < frame.utime_us)
      of_submap.push_back({*pose, frame.sigmas});
  }
  std::vector<std::vector<ToldPose>> lists;
  lists.reserve(told.size());
  for (auto& [submap, poses] : told) lists.push_back(std::move(poses));
  return lists;
}

ordered_json to_json(const WithinSigmas& within) {
  return {{"counted", within.counted}, {"within_one", or_null(within.one)}, {"within_two", or_null(within.two)}};
}

ordered_json to_json(const Honesty& honesty) {
  return {{"position", to_json(honesty.position)},
          {"rotation", to_json(honesty.rotation)},
          {"log_scale", to_json(honesty.log_scale)},
          {"reason", honesty.reason}};
}

std::optional<RunTimes> times_of(const std::vector<InputFrame>& frames) {
  if (frames.empty()) return std::nullopt;
  RunTimes times{frames.front().utime_us, frames.back().utime_us, 0};
  if (frames.size() > 1) times.period_us = (times.last_us - times.first_us) / static_cast<int64_t>(frames.size() - 1);
  return times;
}

std::string span(int64_t first_us, int64_t last_us) {
  return fmt::format("from {:.3f} to {:.3f} s", static_cast<double>(first_us) * 1e-6,
                     static_cast<double>(last_us) * 1e-6);
}

// Returns how many images have a truth, and the times of both, for a note or an error.
std::string how_they_meet(const std::string& file, const TruthFile& truth, const RunTimes& run,
                          const RunMetrics& metrics) {
  return fmt::format("{}: {} of {} images have a truth: the images are {}, the truth is {}", file,
                     metrics.frames_with_truth, metrics.frames, span(run.first_us, run.last_us),
                     span(truth.poses.front().utime_us, truth.poses.back().utime_us));
}

std::string advice(const TruthFile& truth, const RunTimes& run) {
  if (!truth.hint.empty()) return truth.hint;
  const bool overlap = truth.poses.front().utime_us <= run.last_us && truth.poses.back().utime_us >= run.first_us;
  return overlap ? "between its times are larger steps than --max-time-difference bridges"
                 : "give the truth of this recording, in the clock of its images";
}

// Returns a doubt, or an empty string. Errors and rates are in metres, but a file of poses does not name its unit. A
// path in millimetres is recognized by its speed, which no hand, robot or car reaches.
std::string doubt_about_unit(const std::vector<TimedPose>& truth) {
  constexpr double kQuickest = 40;  // m/s; a path with a higher median speed is doubtful
  std::vector<double> speeds;
  for (size_t i = 1; i < truth.size(); ++i)
    if (const int64_t step_us = truth[i].utime_us - truth[i - 1].utime_us; step_us > 0)
      speeds.push_back((truth[i].map_from_cam.translation - truth[i - 1].map_from_cam.translation).norm() /
                       (1e-6 * static_cast<double>(step_us)));
  const double speed = speeds.empty() ? 0 : median(&speeds);
  if (speed < kQuickest) return {};
  return fmt::format(
      "the truth moves at {:.0f} m/s: if it is in millimetres, divide it by 1000, as all errors and rates here take it "
      "for metres",
      speed);
}

// Shifts the truth by the given time, or by the best one if none is given. Adds a note if another shift than the given
// one would be much better.
void shift_truth(const TruthOptions& asked, const std::vector<TimedPose>& map, const MetricOptions& options,
                 TruthFile* truth, RunEvaluation* evaluation) {
  evaluation->truth_shift_s = asked.shift_s.value_or(0);
  truth->poses = shifted(std::move(truth->poses), evaluation->truth_shift_s);
  if (const std::optional<TruthShift> better = find_truth_shift(map, truth->poses, options)) {
    const double seconds = evaluation->truth_shift_s + better->seconds;
    if (asked.shift_s)
      return truth->notes.push_back(
          fmt::format("the truth seems to be {}: ATE {:.4f} m if it is shifted by {:+.2f} s (--truth-shift {:.2f})",
                      better->seconds < 0 ? "late" : "early", better->ate_rmse_m, seconds, seconds));
    truth->poses = shifted(std::move(truth->poses), better->seconds);
    evaluation->truth_shift_s = seconds;
  } else if (!asked.shift_s) {
    truth->notes.push_back(
        "--truth-shift auto: no shift makes the error half as large, or the path is too even to tell: not shifted");
  }
  if (evaluation->truth_shift_s != 0)
    truth->notes.push_back(fmt::format("the truth is shifted by {:+.2f} s", evaluation->truth_shift_s));
}

Result<Submaps> read_submaps(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code no_folder;
  for (const auto& entry : fs::directory_iterator(folder, no_folder))
    if (entry.path().extension() == ".txt") files.push_back(entry.path());
  Submaps submaps;
  for (const fs::path& file : files) {
    TrajectoryFile submap = read_trajectory(file.string());
    if (!submap.ok()) return Error{submap.error};
    submaps[file.stem().string()] = std::move(submap.poses);
  }
  return submaps;
}

std::vector<std::vector<TimedPose>> poses_of(const Submaps& submaps) {
  std::vector<std::vector<TimedPose>> poses;
  for (const auto& [name, submap] : submaps) poses.push_back(submap);
  return poses;
}

std::vector<SubmapResult> evaluate_submaps(const Submaps& submaps, const std::vector<TimedPose>& map,
                                           const std::vector<TimedPose>& truth, const MetricOptions& options) {
  std::vector<SubmapResult> results;
  for (const auto& [name, poses] : submaps)
    results.push_back({name, evaluate_trajectory(poses, truth, options),
                       evaluate_trajectory(at_times_of(poses, map), truth, options).ate_rmse_m});
  return results;
}

int images_of(const ordered_json& run) {
  return run.contains("images") && run["images"].is_number() ? run["images"].get<int>() : 0;
}

std::vector<std::string> notes_on(const TruthFile& truth, const RunMetrics& metrics, const MetricOptions& options) {
  std::vector<std::string> notes = truth.notes;
  if (metrics.map.ate_rmse_m && metrics.frames_with_truth > 0 && !metrics.true_rate)
    notes.push_back(
        fmt::format("all of the truth lies within {:g} m, so that true_rate would tell nothing: ask with a smaller "
                    "--true-distance",
                    options.true_distance_m));
  if (std::string doubt = doubt_about_unit(truth.poses); !doubt.empty()) notes.push_back(std::move(doubt));
  return notes;
}

std::string note_on_skipped(const fs::path& file, const TrajectoryFile& map) {
  return fmt::format(
      "{}: {} lines are not counted: they are no poses, or have the time of another one (as two sessions may whose "
      "clock was set back)",
      file.string(), map.skipped_lines);
}

std::string no_meeting(const std::string& meeting, const TruthFile& truth, const RunTimes& run) {
  std::string text = fmt::format("{}; {}", meeting, advice(truth, run));
  for (const std::string& note : truth.notes) text += "\n  " + note;
  return text;
}

}  // namespace

Result<RunEvaluation> evaluate_folder(const std::string& folder, const std::string& groundtruth,
                                      const EvaluationOptions& options) {
  const fs::path out = folder;
  const TrajectoryFile map = read_trajectory((out / "trajectory.txt").string());
  if (!map.ok()) return Error{map.error};
  const FramesFile frames = read_frames((out / "frames.csv").string());
  if (!frames.ok()) return Error{frames.error};
  TruthOptions truth_options = options.truth;
  truth_options.run = times_of(frames.frames);
  TruthFile truth = options.read_truth(groundtruth, truth_options);
  if (!truth.ok()) return Error{truth.error};
  MetricOptions metrics = options.metrics;
  metrics.truth_has_rotations = truth.has_rotations;
  RunEvaluation evaluation;
  shift_truth(options.truth, map.poses, metrics, &truth, &evaluation);
  const Result<Submaps> submaps = read_submaps(out / "submaps");
  if (!submaps) return submaps.error();
  evaluation.submaps = evaluate_submaps(*submaps, map.poses, truth.poses, metrics);
  evaluation.honesty = evaluate_honesty(told_poses(frames.frames, map.poses, *submaps), truth.poses, metrics);
  const ordered_json run = read_run(out / "run.json");
  evaluation.run = evaluate_run(map.poses, poses_of(*submaps), frames.frames, truth.poses, metrics, images_of(run));
  evaluation.notes = notes_on(truth, evaluation.run, metrics);
  if (map.skipped_lines > 0) evaluation.notes.push_back(note_on_skipped(out / "trajectory.txt", map));
  if (truth_options.run && evaluation.run.frames >= 3) {
    const std::string meeting = how_they_meet(groundtruth, truth, *truth_options.run, evaluation.run);
    if (evaluation.run.frames_with_truth < 3) return Error{no_meeting(meeting, truth, *truth_options.run)};
    if (2 * evaluation.run.frames_with_truth < evaluation.run.frames) evaluation.notes.push_back(meeting);
  }
  evaluation.truth_has_rotations = truth.has_rotations;
  evaluation.truth = std::move(truth.poses);
  if (run.contains("cpu_ms_per_frame") && run["cpu_ms_per_frame"].is_object())
    evaluation.cpu_ms_per_frame = run["cpu_ms_per_frame"];
  return evaluation;
}

ordered_json to_json(const RunEvaluation& evaluation) {
  const RunMetrics& run = evaluation.run;
  double cpu_ms = 0;
  for (const auto& [component, ms] : evaluation.cpu_ms_per_frame.items())
    cpu_ms += ms.is_number() ? ms.get<double>() : 0;
  ordered_json json{
      {"ate_rmse_m", or_null(run.map.ate_rmse_m)},
      {"ate_se3_rmse_m", or_null(run.map.ate_se3_rmse_m)},
      {"rpe_trans_m", or_null(run.map.rpe_trans_m)},
      {"rpe_rot_deg", or_null(run.map.rpe_rot_deg)},
      {"tracked_frame_ratio", or_null(run.tracked_frame_ratio)},
      {"path_m", run.map.path_m},
      {"span_rate", or_null(run.span_rate)},
      {"true_rate", or_null(run.true_rate)},
      {"submap_frame_ratio", or_null(run.submap_frame_ratio)},
      {"frames", run.frames},
      {"tracked_frames", run.tracked_frames},
      {"frames_with_truth", run.map.associated},
      {"scale", run.map.truth_from_estimate ? ordered_json(run.map.truth_from_estimate->scale) : ordered_json()},
      {"submaps", evaluation.submaps.size()},
      {"per_submap", ordered_json::array()},
      {"honesty", to_json(evaluation.honesty)},
      {"ms_per_frame", evaluation.cpu_ms_per_frame.is_null() ? ordered_json() : ordered_json(cpu_ms)},
      {"cpu_ms_per_frame", evaluation.cpu_ms_per_frame},
      {"images_with_truth", run.frames_with_truth},
      {"truth_has_rotations", evaluation.truth_has_rotations},
      {"truth_shift_s", evaluation.truth_shift_s},
      {"notes", evaluation.notes},
      {"reason", run.map.reason},
  };
  for (const SubmapResult& submap : evaluation.submaps) {
    json["per_submap"].push_back({{"name", submap.name},
                                  {"frames", submap.metrics.poses},
                                  {"frames_with_truth", submap.metrics.associated},
                                  {"ate_rmse_m", or_null(submap.metrics.ate_rmse_m)},
                                  {"ate_in_map_rmse_m", or_null(submap.ate_in_map_rmse_m)},
                                  {"path_m", submap.metrics.path_m},
                                  {"reason", submap.metrics.reason}});
  }
  return json;
}

}  // namespace rumi::tool
