// SPDX-License-Identifier: BSD-3-Clause
// Explains the results of the demo to somebody who has never heard of Rumi.
#pragma once

#include <string>

#include "rumi/commands/replay_run.h"
#include "rumi/evaluation/run_evaluation.h"

namespace rumi::tool {

struct MeasuredRun {
  ReplayOutcome outcome;
  RunEvaluation evaluation;
};

// Returns a table that compares a run without rebuilding and a run of the whole of Rumi, on the same images.
std::string demo_table(const MeasuredRun& front, const MeasuredRun& whole);
// Returns sentences: where tracking was lost, which windows were rebuilt, and how many submaps were joined.
std::string demo_story(const ReplayOutcome& whole);

}  // namespace rumi::tool
