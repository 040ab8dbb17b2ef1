// SPDX-License-Identifier: BSD-3-Clause
// The results of the demo, in words and numbers for somebody who has never heard of Rumi.
#pragma once

#include <string>

#include "rumi/commands/replay_run.h"
#include "rumi/evaluation/run_evaluation.h"

namespace rumi::tool {

struct MeasuredRun {
  ReplayOutcome outcome;
  RunEvaluation evaluation;
};

// The front alone and the whole of Rumi on the same images, side by side.
std::string demo_table(const MeasuredRun& front, const MeasuredRun& whole);
// Tells where tracking was lost, which windows were rebuilt, and how many submaps were joined.
std::string demo_story(const ReplayOutcome& whole);

}  // namespace rumi::tool
