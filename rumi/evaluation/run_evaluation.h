// SPDX-License-Identifier: BSD-3-Clause
// Evaluates the outputs of a run against the true path.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "formats/truth/truth.h"
#include "rumi/evaluation/honesty.h"
#include "rumi/evaluation/metrics.h"

namespace rumi::tool {

struct SubmapResult {
  std::string name;  // name of its file without .txt
  TrajectoryMetrics metrics;
  std::optional<double> ate_in_map_rmse_m;  // ATE of the same frames in the served map, after an alignment of their own
};

struct RunEvaluation {
  RunMetrics run;
  std::vector<SubmapResult> submaps;
  Honesty honesty;  // honesty of the deviations in frames.csv
  std::vector<TimedPose> truth;
  bool truth_has_rotations = true;
  double truth_shift_s = 0;                 // seconds that were added to the times of the truth
  std::vector<std::string> notes;           // on the truth: how it was read, and which lines were left out
  nlohmann::ordered_json cpu_ms_per_frame;  // by component, from run.json; null if run.json does not have it
};

using ReadTruth = std::function<TruthFile(const std::string&, const TruthOptions&)>;

struct EvaluationOptions {
  TruthOptions truth = {};
  MetricOptions metrics = {};
  ReadTruth read_truth = read_groundtruth;
};

// Reads trajectory.txt, frames.csv and submaps/ in the folder, and the truth. An Error if a file cannot be read, or if
// fewer than three images have a truth. If fewer than three images have a pose, `run.map.reason` says so.
Result<RunEvaluation> evaluate_folder(const std::string& folder, const std::string& groundtruth,
                                      const EvaluationOptions& options = {});

nlohmann::ordered_json to_json(const RunEvaluation& evaluation);

}  // namespace rumi::tool
