// SPDX-License-Identifier: BSD-3-Clause
// rumi evaluate OUT --groundtruth F: how good the outputs of a run are.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "rumi/commands.h"
#include "rumi/evaluation_plot.h"
#include "rumi/metrics.h"

namespace rumi {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

struct Arguments {
  std::string out, groundtruth;
  bool json = false;
  TruthOptions truth;
  MetricOptions metrics;
};

struct SubmapResult {
  std::string name;  // of its file
  TrajectoryMetrics metrics;
};

struct Evaluation {
  RunMetrics run;
  std::vector<SubmapResult> submaps;
  std::vector<TimedPose> truth;
  ordered_json cpu_ms_per_frame;  // by component, from run.json; null if it is not there
};

template <class T>
ordered_json or_null(const std::optional<T>& value) {
  return value ? ordered_json(*value) : ordered_json();
}

// What the run said of itself; its absence is no reason not to evaluate the trajectory.
ordered_json read_run(const fs::path& run_json) {
  std::ifstream in(run_json);
  ordered_json run = ordered_json::parse(in, nullptr, /*allow_exceptions=*/false);
  return run.is_object() ? run : ordered_json::object();
}

// Returns what is wrong, or nothing.
std::string load_and_evaluate(const Arguments& arguments, Evaluation* evaluation) {
  const fs::path out = arguments.out;
  const TrajectoryFile map = read_trajectory((out / "trajectory.txt").string());
  if (!map.ok()) return map.error;
  const FramesFile frames = read_frames((out / "frames.csv").string());
  if (!frames.ok()) return frames.error;
  TrajectoryFile truth = read_groundtruth(arguments.groundtruth, arguments.truth);
  if (!truth.ok()) return truth.error;

  std::vector<fs::path> files;
  std::error_code no_folder;
  for (const auto& entry : fs::directory_iterator(out / "submaps", no_folder)) {
    if (entry.path().extension() == ".txt") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  std::vector<std::vector<TimedPose>> submaps;
  for (const fs::path& file : files) {
    const TrajectoryFile submap = read_trajectory(file.string());
    if (!submap.ok()) return submap.error;
    submaps.push_back(submap.poses);
    evaluation->submaps.push_back(
        {file.stem().string(), evaluate_trajectory(submap.poses, truth.poses, arguments.metrics)});
  }
  const ordered_json run = read_run(out / "run.json");
  const int images = run.contains("images") && run["images"].is_number() ? run["images"].get<int>() : 0;
  evaluation->run = evaluate_run(map.poses, submaps, frames.frames, truth.poses, arguments.metrics, images);
  evaluation->truth = std::move(truth.poses);
  if (run.contains("cpu_ms_per_frame") && run["cpu_ms_per_frame"].is_object()) {
    evaluation->cpu_ms_per_frame = run["cpu_ms_per_frame"];
  }
  return "";
}

ordered_json to_json(const Evaluation& evaluation) {
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
      {"span_rate", or_null(run.span_rate)},
      {"true_rate", or_null(run.true_rate)},
      {"submap_frame_ratio", or_null(run.submap_frame_ratio)},
      {"frames", run.frames},
      {"tracked_frames", run.tracked_frames},
      {"frames_with_truth", run.map.associated},
      {"scale", run.map.truth_from_estimate ? ordered_json(run.map.truth_from_estimate->scale) : ordered_json()},
      {"submaps", evaluation.submaps.size()},
      {"per_submap", ordered_json::array()},
      {"ms_per_frame", evaluation.cpu_ms_per_frame.is_null() ? ordered_json() : ordered_json(cpu_ms)},
      {"cpu_ms_per_frame", evaluation.cpu_ms_per_frame},
      {"reason", run.map.reason},
  };
  for (const SubmapResult& submap : evaluation.submaps) {
    json["per_submap"].push_back({{"name", submap.name},
                                  {"frames", submap.metrics.poses},
                                  {"frames_with_truth", submap.metrics.associated},
                                  {"ate_rmse_m", or_null(submap.metrics.ate_rmse_m)},
                                  {"path_m", submap.metrics.path_m},
                                  {"reason", submap.metrics.reason}});
  }
  return json;
}

std::string number(const ordered_json& value, const char* unit) {
  return value.is_number() ? fmt::format("{:.4f}{}", value.get<double>(), unit) : "cannot be computed";
}

void print_report(const ordered_json& json) {
  const auto line = [&](const char* what, const char* key, const char* unit) {
    fmt::print("{:<44}{}\n", what, number(json[key], unit));
  };
  line("ATE RMSE after Sim(3) alignment", "ate_rmse_m", " m");
  line("ATE RMSE after SE(3) alignment", "ate_se3_rmse_m", " m");
  line("RPE over the interval, translation", "rpe_trans_m", " m");
  line("RPE over the interval, rotation", "rpe_rot_deg", " deg");
  line("tracked_frame_ratio (in the served map)", "tracked_frame_ratio", "");
  line("submap_frame_ratio (in any submap)", "submap_frame_ratio", "");
  line("span_rate (first to last pose)", "span_rate", "");
  line("true_rate (near the truth / all frames)", "true_rate", "");
  line("CPU of all components", "ms_per_frame", " ms per frame");
  fmt::print("{:<44}{} of {}, {} with a truth\n", "frames with a pose", json["tracked_frames"].get<int>(),
             json["frames"].get<int>(), json["frames_with_truth"].get<int>());
  fmt::print("{:<44}{}\n", "submaps", json["submaps"].get<int>());
  for (const auto& submap : json["per_submap"]) {
    fmt::print("  submap {:<35}{} frames, ATE {}, path {}\n", submap["name"].get<std::string>(),
               submap["frames"].get<int>(), number(submap["ate_rmse_m"], " m"), number(submap["path_m"], " m"));
  }
  if (const auto reason = json["reason"].get<std::string>(); !reason.empty()) fmt::print("note: {}\n", reason);
}

int evaluate(const Arguments& arguments) {
  Evaluation evaluation;
  if (const std::string error = load_and_evaluate(arguments, &evaluation); !error.empty()) {
    fmt::print(stderr, "rumi evaluate: {}\n", error);
    return 1;
  }
  const ordered_json json = to_json(evaluation);
  if (arguments.json) {
    fmt::print("{}\n", json.dump(2));
  } else {
    print_report(json);
  }
  const std::string png = (fs::path(arguments.out) / "evaluation.png").string();
  if (const std::string error = plot_evaluation(evaluation.run, evaluation.truth, png); !error.empty()) {
    fmt::print(stderr, "rumi evaluate: {}\n", error);
    return 1;
  }
  return 0;
}

}  // namespace

void add_evaluate_command(CLI::App& app, std::function<int()>* chosen) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("evaluate", "Measure the outputs of a run against the true path");
  command->add_option("OUT", arguments->out, "output folder of `rumi replay` or `rumi snapshot`")->required();
  command
      ->add_option("--groundtruth", arguments->groundtruth,
                   "true path of the camera in TUM format, or EuRoC's state_groundtruth_estimate0/data.csv")
      ->required();
  command->add_flag("--json", arguments->json, "print JSON");
  command
      ->add_option("--groundtruth-rate", arguments->truth.frames_per_second,
                   "the truth's first column counts frames at this rate, Hz (ICL-NUIM); 0: it is seconds")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command
      ->add_option("--max-time-difference", arguments->metrics.max_time_difference_s,
                   "between a pose and its truth, s; never more than half the frame period")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command
      ->add_option("--true-distance", arguments->metrics.true_distance_m,
                   "true_rate counts frames nearer to the truth than this, m")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--rpe-interval", arguments->metrics.rpe_interval_s, "of the relative pose error, s")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->callback([arguments, chosen] { *chosen = [arguments] { return evaluate(*arguments); }; });
}

}  // namespace rumi
