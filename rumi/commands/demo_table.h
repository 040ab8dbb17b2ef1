// SPDX-License-Identifier: BSD-3-Clause
// What the demo shows, in words and numbers for somebody who has never heard of it.
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
// What happened: where tracking was lost, what was rebuilt of it, and what became of the submaps.
std::string demo_story(const ReplayOutcome& whole);

}  // namespace rumi::tool
