// SPDX-License-Identifier: BSD-3-Clause
// rumi evaluate OUT [--groundtruth F]: measures how good the outputs of a run are.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>

#include "base/text/json_text.h"
#include "base/text/number_text.h"
#include "rumi/commands/command_frame.h"
#include "rumi/commands/commands.h"
#include "rumi/evaluation/run_evaluation.h"
#include "rumi/recordings/truth_of_recording.h"
#include "rumi/report/evaluation_plot.h"

namespace rumi::tool {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

struct Arguments {
  std::string out, groundtruth, truth_shift = "0";
  bool json = false;
  TruthOptions truth;
  MetricOptions metrics;
};

std::string number(const ordered_json& value, const char* unit) {
  return value.is_number() ? fmt::format("{:.4f}{}", value.get<double>(), unit) : "cannot be computed";
}

void print_report(const ordered_json& json) {
  const auto line = [&](const char* what, const char* key, const char* unit) {
    fmt::print("{:<44}{}\n", what, number(json[key], unit));
  };
  line("ATE RMSE after Sim(3) alignment", "ate_rmse_m", " m");
  line("ATE RMSE after SE(3) alignment", "ate_se3_rmse_m", " m");
  if (json["truth_has_rotations"].get<bool>()) {
    line("RPE over the interval, translation", "rpe_trans_m", " m");
    line("RPE over the interval, rotation", "rpe_rot_deg", " deg");
  } else {
    fmt::print("{:<44}needs rotations, which are not in this file\n", "RPE over the interval");
  }
  line("tracked_frame_ratio (in the served map)", "tracked_frame_ratio", "");
  line("submap_frame_ratio (in any submap)", "submap_frame_ratio", "");
  line("span_rate (first to last pose)", "span_rate", "");
  line("true_rate (near the truth / with a truth)", "true_rate", "");
  line("CPU of all components", "ms_per_frame", " ms per frame");
  const auto honesty = [&](const char* what, const char* key) {
    const ordered_json& within = json["honesty"][key];
    if (within["counted"].get<int>() == 0) return fmt::print("{:<44}cannot be computed\n", what);
    fmt::print("{:<44}{:.3f} and {:.3f} of {}\n", what, within["within_one"].get<double>(),
               within["within_two"].get<double>(), within["counted"].get<int>());
  };
  honesty("position within 1 and 2 sigma (.683, .954)", "position");
  honesty("rotation within 1 and 2 sigma", "rotation");
  honesty("drift of scale within 1 and 2 sigma", "log_scale");
  fmt::print("{:<44}{} of {}, {} with a truth\n", "frames with a pose", json["tracked_frames"].get<int>(),
             json["frames"].get<int>(), json["frames_with_truth"].get<int>());
  fmt::print("{:<44}{}\n", "submaps", json["submaps"].get<int>());
  for (const auto& submap : json["per_submap"]) {
    fmt::print("  submap {:<35}{} frames, ATE {} (as the map has them {}), path {}\n",
               submap["name"].get<std::string>(), submap["frames"].get<int>(), number(submap["ate_rmse_m"], " m"),
               number(submap["ate_in_map_rmse_m"], " m"), number(submap["path_m"], " m"));
  }
  for (const ordered_json& note : json["notes"]) fmt::print("note: {}\n", note.get<std::string>());
  const std::string reason = json["reason"], of_honesty = json["honesty"]["reason"];
  if (!reason.empty()) fmt::print("note: {}\n", reason);
  if (!of_honesty.empty() && of_honesty != reason) fmt::print("note: {}\n", of_honesty);
}

// If no truth is given, takes the one beside the recording of the run. Throws std::runtime_error if there is none.
void choose_truth(Arguments& arguments) {
  if (!arguments.groundtruth.empty()) return;
  const fs::path file = fs::path(arguments.out) / "run.json";
  std::ifstream in(file);
  const ordered_json run = ordered_json::parse(in, nullptr, /*allow_exceptions=*/false);
  const std::string recording =
      run.is_object() && run.contains("input") && run["input"].is_string() ? run["input"] : "";
  if (recording.empty())
    fail_if(fmt::format("{}: names no recording (input) beside which a truth could be: give --groundtruth FILE",
                        file.string()));
  const FoundTruth found = find_truth(recording);
  if (!found.error.empty()) fail_if(fmt::format("{}: {}; give --groundtruth FILE", arguments.out, found.error));
  arguments.groundtruth = found.file;
  if (arguments.truth.frames_per_second > 0 || found.frames_per_second == 0) return;
  const ordered_json rate = run.value(ordered_json::json_pointer("/options/camera_driver/rate"), ordered_json());
  arguments.truth.frames_per_second =
      rate.is_number() && rate.get<double>() > 0 ? rate.get<double>() : found.frames_per_second;
}

Result<> read_shift(Arguments& arguments) {
  arguments.truth.shift_s.reset();
  if (arguments.truth_shift == "auto") return {};
  arguments.truth.shift_s = parse_number<double>(without_plus(arguments.truth_shift));
  constexpr double kLongest = 1e9;  // largest shift, s; the clocks of images and truth may have any origin
  if (arguments.truth.shift_s && std::abs(*arguments.truth.shift_s) <= kLongest) return {};
  return Error{fmt::format("--truth-shift is '{}': must be a number of seconds, or auto", arguments.truth_shift)};
}

void evaluate(Arguments& arguments) {
  refuse_if(read_shift(arguments));
  choose_truth(arguments);
  const RunEvaluation evaluation = value_or_fail(
      evaluate_folder(arguments.out, arguments.groundtruth, {arguments.truth, arguments.metrics, read_truth}));
  if (!arguments.json) fmt::print("{:<44}{}\n", "truth", arguments.groundtruth);
  const ordered_json json = to_json(evaluation);
  if (arguments.json) {
    fmt::print("{}\n", json_text(json, 2));
  } else {
    print_report(json);
  }
  const std::string png = (fs::path(arguments.out) / "evaluation.png").string();
  // A picture that cannot be written is no failure, as OUT may be read-only.
  if (const Result<> plotted = plot_evaluation(evaluation.run, evaluation.truth, png); !plotted)
    complain("evaluate", plotted.error().text() + ": there is no picture");
  if (!evaluation.run.map.ate_rmse_m)
    fail_if(fmt::format("{}: nothing could be computed: {}", arguments.out, evaluation.run.map.reason));
}

}  // namespace

void add_evaluate_command(CommandLine& app, std::function<int()>* chosen) {
  auto arguments = std::make_shared<Arguments>();
  CommandLine* command = app.add_command("evaluate", "Measure the outputs of a run against the true path");
  command->add_option("OUT", arguments->out, "output folder of `rumi replay` or `rumi snapshot`")->required();
  command
      ->add_option(
          "--groundtruth", arguments->groundtruth,
          "true path: TUM's lines, EuRoC's or TUM-VI's data.csv, KITTI's matrices, positions only, or a ROS bag "
          "with the camera in /tf; without it the one that lies beside the recording of the run")
      ->type_name("FILE");
  command->add_flag("--json", arguments->json, "print JSON");
  command
      ->add_option(
          "--groundtruth-rate", arguments->truth.frames_per_second,
          "the truth's first column counts images at this rate, Hz (ICL-NUIM), or there are no times (KITTI); 0: "
          "there are")
      ->not_negative()
      ->show_default();
  command
      ->add_option("--truth-shift", arguments->truth_shift,
                   "added to the times of the truth, whose clock may be another one, s; auto: what makes the error "
                   "half as large or less, if anything clearly does")
      ->type_name("SECONDS")
      ->show_default();
  command
      ->add_option("--max-time-difference", arguments->metrics.max_time_difference_s,
                   "between a pose and its truth, s; never more than half the frame period")
      ->positive()
      ->show_default();
  command
      ->add_option("--true-distance", arguments->metrics.true_distance_m,
                   "true_rate counts frames nearer to the truth than this, m")
      ->positive()
      ->show_default();
  command
      ->add_option("--rpe-interval", arguments->metrics.rpe_interval_s,
                   "of the relative pose error, and around a pose where its deviations are judged, s")
      ->positive()
      ->show_default();
  run_if_chosen(command, chosen, arguments, evaluate);
}

}  // namespace rumi::tool
