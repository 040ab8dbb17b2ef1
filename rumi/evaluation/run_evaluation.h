// SPDX-License-Identifier: BSD-3-Clause
// The outputs of a run against the true path.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "formats/truth/truth.h"
#include "rumi/evaluation/honesty.h"
#include "rumi/evaluation/metrics.h"

namespace rumi::tool {

struct SubmapResult {
  std::string name;  // of its file
  TrajectoryMetrics metrics;
  std::optional<double> ate_in_map_rmse_m;  // of the same frames in the served map, aligned by themselves
};

struct RunEvaluation {
  RunMetrics run;
  std::vector<SubmapResult> submaps;
  Honesty honesty;  // of the deviations in frames.csv
  std::vector<TimedPose> truth;
  bool truth_has_rotations = true;
  double truth_shift_s = 0;                 // that was added to its times
  std::vector<std::string> notes;           // on the truth: what was decided, or left out
  nlohmann::ordered_json cpu_ms_per_frame;  // by component, from run.json; null if it is not there
};

using ReadTruth = std::function<TruthFile(const std::string&, const TruthOptions&)>;

// Reads trajectory.txt, frames.csv and submaps/ in the folder, and the truth. Returns what is wrong, or nothing. It is
// wrong if fewer than three images have a truth; that fewer have a pose is told by `run.map.reason`.
std::string evaluate_folder(const std::string& folder, const std::string& groundtruth, const TruthOptions& truth,
                            const MetricOptions& metrics, RunEvaluation* evaluation,
                            const ReadTruth& read_truth = read_groundtruth);

nlohmann::ordered_json to_json(const RunEvaluation& evaluation);

}  // namespace rumi::tool
